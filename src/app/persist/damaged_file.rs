//! Damaged files: renaming, and the line of the error.

use std::path::Path;

use crate::app::model::findings::unusable_file_kept;
use resect_core::deployment::Finding;

/// Renames a damaged file so that it is not overwritten. Returns true if that succeeded, and a finding. If it failed, the file must not be
/// overwritten.
pub fn keep_aside(path: &Path, why: &str) -> (bool, Finding) {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let free = (1..1000)
        .map(|number| match number {
            1 => path.with_file_name(format!("{name}.bak")),
            _ => path.with_file_name(format!("{name}.{number}.bak")),
        })
        .find(|kept| !kept.exists());
    let moved = free.and_then(|kept| std::fs::rename(path, &kept).ok().map(|()| kept));
    (moved.is_some(), unusable_file_kept(why, moved.as_deref()))
}

/// Line number of a byte in a text, from 1.
pub fn line_of(text: &str, byte: usize) -> usize {
    1 + text.bytes().take(byte).filter(|byte| *byte == b'\n').count()
}
