//! Tells the tests whether the field data lies beside the project, so that those that need it are seen to be ignored.

#![allow(clippy::print_stdout, reason = "that is how cargo is told")]

fn main() {
    println!("cargo::rustc-check-cfg=cfg(field_data)");
    let folder = "../shared/datasets";
    if std::path::Path::new(folder).exists() {
        println!("cargo::rustc-cfg=field_data");
        println!("cargo::rerun-if-changed={folder}");
    } else {
        // What is not there would be changed at every build.
        println!("cargo::rerun-if-changed=build.rs");
    }
}
