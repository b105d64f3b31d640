//! Sets the cfg `field_data` where the field data is beside the project, and folds identical functions of the release.

#![allow(clippy::print_stdout, reason = "cargo reads the standard output")]

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rustc-check-cfg=cfg(field_data)");
    let folder = "../shared/datasets";
    if Path::new(folder).exists() {
        println!("cargo::rustc-cfg=field_data");
        println!("cargo::rerun-if-changed={folder}");
    } else {
        // Cargo runs the script at every build if the path does not exist.
        println!("cargo::rerun-if-changed=build.rs");
    }
    let is_release = std::env::var("PROFILE").is_ok_and(|profile| profile == "release");
    if is_release && links_with_lld() {
        println!("cargo::rustc-link-arg-bins=-Wl,--icf=safe");
    }
}

/// Returns true if the compiler links with its own LLD: GNU ld does not know the option `--icf`.
///
/// Since Rust 1.90 that is the default of this target, where the toolchain includes LLD.
fn links_with_lld() -> bool {
    let target = std::env::var("TARGET").unwrap_or_default();
    let rustc = std::env::var("RUSTC").unwrap_or_default();
    let Ok(output) = Command::new(rustc).args(["--print", "target-libdir"]).output() else {
        return false;
    };
    let libraries = String::from_utf8_lossy(&output.stdout);
    let lld = Path::new(libraries.trim()).with_file_name("bin/gcc-ld/ld.lld");
    target == "x86_64-unknown-linux-gnu" && lld.exists()
}
