//! Differences of Windows: forms of paths, and files that another program has open.

use std::io::Error;
use std::path::{Path, PathBuf};

/// Returns true if another program has opened the file without sharing it, or locked a part of it. Only Windows refuses these files.
pub fn is_in_use(error: &Error) -> bool {
    // ERROR_SHARING_VIOLATION and ERROR_LOCK_VIOLATION, for which the standard library has no kind.
    cfg!(windows) && matches!(error.raw_os_error(), Some(32 | 33))
}

/// Returns the remedy for a file that cannot be read.
pub fn reading_remedy(error: &Error) -> &'static str {
    if is_in_use(error) {
        "close the program that has the file open"
    } else {
        "check the path and its permissions"
    }
}

/// Returns the canonical path in the form that users and other programs know: `C:\a` instead of `\\?\C:\a`.
pub fn canonical(path: &Path) -> std::io::Result<PathBuf> {
    let canonical = path.canonicalize();
    if !cfg!(windows) {
        return canonical;
    }
    match canonical {
        Ok(path) => Ok(path.to_str().and_then(without_prefix).map_or(path, PathBuf::from)),
        // Drives in memory have no canonical paths, and neither have long ones under Wine.
        Err(_) if path.exists() => std::path::absolute(path),
        Err(error) => Err(error),
    }
}

/// Longest path without the prefix `\\?\` (MAX_PATH with its final zero).
const LONGEST_PLAIN_BYTES: usize = 259;

/// Returns a path without its prefix `\\?\`; `None` if it needs the prefix, or has none.
fn without_prefix(path: &str) -> Option<String> {
    let rest = path.strip_prefix(r"\\?\")?;
    let plain = match rest.strip_prefix(r"UNC\") {
        Some(share) => format!(r"\\{share}"),
        None if rest.as_bytes().get(1) == Some(&b':') => rest.to_owned(),
        None => return None,
    };
    // Without the prefix, Windows drops final dots and blanks of a name.
    let is_kept = plain.split('\\').all(|name| !name.ends_with(['.', ' ']));
    (is_kept && plain.len() <= LONGEST_PLAIN_BYTES).then_some(plain)
}

/// Returns a relative path with slashes, which all systems read: sessions and `deployment.toml` move between systems.
pub fn with_slashes(path: &Path) -> PathBuf {
    match path.to_str() {
        Some(text) if cfg!(windows) => PathBuf::from(text.replace('\\', "/")),
        _ => path.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_canonical_path_is_plain_where_windows_can_read_it() {
        for (path, expected) in [
            (r"\\?\C:\drives\a.db3", Some(r"C:\drives\a.db3")),
            (r"\\?\UNC\server\share\a.db3", Some(r"\\server\share\a.db3")),
            (r"\\?\Volume{1b3c}\a.db3", None),
            (r"\\?\C:\drives.\a.db3", None),
            (r"C:\drives\a.db3", None),
        ] {
            assert_eq!(without_prefix(path).as_deref(), expected);
        }
        assert_eq!(without_prefix(&format!(r"\\?\C:\{}", "x".repeat(300))), None);
    }

    #[test]
    fn only_windows_changes_paths() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().canonicalize().expect("there");
        if !cfg!(windows) {
            assert_eq!(canonical(folder.path()).expect("there"), path);
            assert_eq!(with_slashes(Path::new(r"a\b")), Path::new(r"a\b"));
            assert!(!is_in_use(&Error::from_raw_os_error(32)));
        }
    }
}
