//! The page as a file that is either the old one or the new one, never half of it.

use std::path::{Path, PathBuf};

#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be written: {error}; choose a folder that is there and that you may write to", path.display())]
pub struct ReportFileError {
    pub path: PathBuf,
    pub error: std::io::Error,
}

pub fn write(html: &str, path: &Path) -> Result<(), ReportFileError> {
    let result = match path.symlink_metadata() {
        // A pipe, a device or a link is written to, not replaced.
        Ok(metadata) if !metadata.is_file() => std::fs::write(path, html),
        _ => replace(html, path),
    };
    result.map_err(|error| ReportFileError { path: path.to_owned(), error })
}

/// Writes beside the file, then takes its place.
fn replace(html: &str, path: &Path) -> std::io::Result<()> {
    let mut name = std::ffi::OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}.part", std::process::id()));
    let part = path.with_file_name(name);
    let result = std::fs::write(&part, html).and_then(|()| std::fs::rename(&part, path));
    if result.is_err() {
        // What is to be told is the first error, not that the part is not there either.
        _ = std::fs::remove_file(&part);
    }
    result
}
