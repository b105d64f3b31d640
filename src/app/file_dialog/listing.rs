//! Content of a folder, for the path dialog.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use resect_io::what_is::what_is;

/// Time limit for identifying files; the remaining ones are listed without a description.
const LONGEST_LOOK: Duration = Duration::from_secs(2);

/// A line of the listing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    pub name: String,
    pub is_folder: bool,
    /// Description by the reader that recognises it; empty if none does.
    pub what: &'static str,
}

/// Entries of a folder, folders first, each sorted by name; or the reason why they cannot be shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Listing {
    pub folder: PathBuf,
    pub entries: Result<Vec<Entry>, String>,
}

impl Listing {
    /// Reads the folder, and the beginning of every file in it; not for the thread that draws.
    pub fn read(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), entries: entries(folder) }
    }
}

fn entries(folder: &Path) -> Result<Vec<Entry>, String> {
    let started = Instant::now();
    let read =
        std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut entries: Vec<Entry> = read
        .flatten()
        .map(|entry| {
            let path = entry.path();
            let is_folder = path.is_dir();
            let name = entry.file_name().to_string_lossy().into_owned();
            let look = !is_folder && path.is_file() && started.elapsed() < LONGEST_LOOK;
            let what = if look { what_is(&path).label() } else { "" };
            Entry { name, is_folder, what }
        })
        .collect();
    entries.sort_by_cached_key(|entry| (!entry.is_folder, entry.name.to_lowercase()));
    Ok(entries)
}
