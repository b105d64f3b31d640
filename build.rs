//! Sets the cfg `field_data` where the field data is beside the project, names the build for `resect --version`, and packs the JSON Schema.

#![allow(clippy::print_stdout, reason = "cargo reads the standard output")]

use std::path::Path;

fn main() {
    name_build();
    pack_schema();
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

/// Writes the JSON Schema without the blanks between its tokens, a quarter of the file: the program may have 40 MB.
fn pack_schema() {
    const SCHEMA: &str = "assets/schema.json";
    println!("cargo::rerun-if-changed={SCHEMA}");
    let schema = std::fs::read_to_string(SCHEMA).expect("the schema");
    // No string of the schema has an escaped quotation mark.
    let is_text = |part: usize| part % 2 == 1;
    let parts = schema.split('"').enumerate().map(|(part, text)| match is_text(part) {
        true => text.to_owned(),
        false => text.split_whitespace().collect(),
    });
    let packed = parts.collect::<Vec<_>>().join("\"");
    let folder = std::env::var_os("OUT_DIR").expect("cargo sets it");
    std::fs::write(Path::new(&folder).join("schema.json"), packed).expect("written");
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
