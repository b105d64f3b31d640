//! Files that cannot be used: where they are kept, and the line of the error.

use std::path::Path;

use resect_core::deployment::Finding;

/// Moves a file that cannot be used out of the way of the one that will be written; whether it could, and what to
/// say. One that stays where it is must not be written over.
pub fn keep_aside(path: &Path, why: &str) -> (bool, Finding) {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let free = (1..1000)
        .map(|number| match number {
            1 => path.with_file_name(format!("{name}.bak")),
            _ => path.with_file_name(format!("{name}.{number}.bak")),
        })
        .find(|kept| !kept.exists());
    let moved = free.and_then(|kept| std::fs::rename(path, &kept).ok().map(|()| kept));
    let line = match &moved {
        Some(kept) => format!("{why}; it is kept as {}", kept.display()),
        None => format!("{why}; it could not be moved aside and stays as it is"),
    };
    (moved.is_some(), Finding::warning(line))
}

/// Line of a byte of a text, from 1.
pub fn line_of(text: &str, byte: usize) -> usize {
    1 + text.bytes().take(byte).filter(|byte| *byte == b'\n').count()
}
