//! Sets the cfg `field_data` where the field data is beside the project, names the build for `resect --version`, and gives the program for Windows its icon, version and manifest.

#![allow(clippy::print_stdout, reason = "cargo reads the standard output")]

use std::io;
use std::path::{Path, PathBuf};

fn main() {
    name_build();
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "windows")
        && let Err(error) = add_windows_resources()
    {
        println!(
            "cargo::error=the resources of the program for Windows: {error}; install windres or rc.exe"
        );
    }
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

/// Links icon, version and manifest into the program. The resource compiler is `rc.exe`, or `windres` for the GNU targets.
fn add_windows_resources() -> io::Result<()> {
    for file in ["build.rs", "assets/icon.png", "packaging/windows.manifest"] {
        println!("cargo::rerun-if-changed={file}");
    }
    let variable = |name: &str| std::env::var_os(name).unwrap_or_default();
    let icon = PathBuf::from(variable("OUT_DIR")).join("resect.ico");
    std::fs::write(&icon, ico(&std::fs::read("assets/icon.png")?))?;
    let manifest = PathBuf::from(variable("CARGO_MANIFEST_DIR")).join("packaging/windows.manifest");
    let mut resources = winresource::WindowsResource::new();
    resources
        .set("OriginalFilename", "resect.exe")
        .set("LegalCopyright", "MIT license")
        .set_icon(&icon.to_string_lossy())
        .set_manifest_file(&manifest.to_string_lossy());
    resources.compile_for("resect")
}

/// Returns a PNG of 256 × 256 pixels as an icon file: a header, one entry, and the PNG itself. Windows scales it to the smaller sizes.
fn ico(png: &[u8]) -> Vec<u8> {
    const HEADER_BYTES: u32 = 22;
    // Type 1 (icon), one entry; width and height 0 stand for 256; one plane, 32 bits a pixel.
    let mut file = vec![0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 1, 0, 32, 0];
    file.extend(u32::try_from(png.len()).expect("a small icon").to_le_bytes());
    file.extend(HEADER_BYTES.to_le_bytes());
    file.extend(png);
    file
}
