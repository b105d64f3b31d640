//! Writes the manual pages of the program and of each of its commands into a folder.
//!
//! ```sh
//! cargo run --release --example man_pages -- target/man
//! ```

use std::path::PathBuf;

use anyhow::Context;

fn main() -> anyhow::Result<()> {
    let folder: PathBuf = std::env::args_os().nth(1).context("give a folder to write into")?.into();
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    clap_mangen::generate_to(resect::command::arguments(), &folder)
        .with_context(|| folder.display().to_string())
}
