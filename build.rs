//! Sets the cfg `field_data` where the field data is beside the project, and names the build for `resect --version`.

#![allow(clippy::print_stdout, reason = "cargo reads the standard output")]

use std::path::Path;

fn main() {
    name_build();
    println!("cargo::rustc-check-cfg=cfg(field_data)");
    let folder = "../shared/datasets";
    if Path::new(folder).exists() {
        println!("cargo::rustc-cfg=field_data");
        println!("cargo::rerun-if-changed={folder}");
    } else {
        // Cargo runs the script at every build if the path does not exist.
        println!("cargo::rerun-if-changed=build.rs");
    }
}

/// Sets `RESECT_BUILD` to the commit and the features. Scripts that build releases give the commit as `RESECT_COMMIT`; reading it from the
/// repository would rebuild the program at each commit.
fn name_build() {
    println!("cargo::rerun-if-env-changed=RESECT_COMMIT");
    let commit = std::env::var("RESECT_COMMIT").map_or_else(
        |_| "built from source".to_owned(),
        |commit| format!("commit {}", commit.chars().take(12).collect::<String>()),
    );
    let rerun = if std::env::var_os("CARGO_FEATURE_RERUN").is_some() { "rerun" } else { "none" };
    println!("cargo::rustc-env=RESECT_BUILD={commit}; features: {rerun}");
}
