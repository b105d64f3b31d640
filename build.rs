//! Sets the cfg `field_data` where the field data is beside the project.

#![allow(clippy::print_stdout, reason = "cargo reads the standard output")]

use std::path::Path;

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
}
