//! Temporary files: hidden, beside their target, recognisable by their names.
//!
//! The writing process locks its temporary file; the lock ends with the process. A temporary file that can be locked is therefore
//! abandoned. This needs no list of processes, and works if several machines or containers share a folder.

use std::ffi::OsString;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// A temporary file, removed when dropped.
pub(super) struct Part {
    /// Locked as long as it is open.
    file: File,
    path: PathBuf,
    target: PathBuf,
    is_placed: bool,
}

impl Part {
    /// Creates an empty temporary file beside its target.
    pub(super) fn beside(target: &Path) -> std::io::Result<Self> {
        loop {
            let path = part_of(target);
            let file = match File::options().write(true).create_new(true).open(&path) {
                // Left by an earlier process with the same id, on a file system without locks.
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => continue,
                other => other?,
            };
            // Without locks, as on some network file systems, abandoned files are not removed either.
            _ = file.lock();
            // Between opening and locking, another process may have removed it as abandoned.
            if path.exists() {
                return Ok(Self { file, path, target: target.to_owned(), is_placed: false });
            }
        }
    }

    pub(super) fn file(&self) -> &File {
        &self.file
    }

    /// Replaces the target.
    pub(super) fn place(mut self) -> std::io::Result<()> {
        std::fs::rename(&self.path, &self.target)?;
        self.is_placed = true;
        sync_folder(folder_of(&self.target));
        Ok(())
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        if !self.is_placed {
            _ = std::fs::remove_file(&self.path);
        }
    }
}

/// Removes temporary files of a target whose processes have ended.
pub(super) fn remove_left_of(target: &Path) {
    let Some(name) = target.file_name() else { return };
    let Ok(entries) = std::fs::read_dir(folder_of(target)) else { return };
    for entry in entries.flatten() {
        let part = entry.file_name();
        let is_of_target = target_name(part.as_encoded_bytes()) == Some(name.as_encoded_bytes());
        // Opening a pipe would block.
        if is_of_target && entry.file_type().is_ok_and(|kind| kind.is_file()) {
            remove_if_left(&entry.path());
        }
    }
}

fn remove_if_left(part: &Path) {
    if let Ok(file) = File::options().write(true).open(part)
        && file.try_lock().is_ok()
    {
        _ = std::fs::remove_file(part);
    }
}

/// Returns a unique name, so that two simultaneous writes do not mix.
fn part_of(path: &Path) -> PathBuf {
    static WRITES: AtomicU64 = AtomicU64::new(0);
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    let number = WRITES.fetch_add(1, Ordering::Relaxed);
    name.push(format!(".{}-{number}.part", std::process::id()));
    path.with_file_name(name)
}

/// Returns the target of an abandoned temporary file; `None` if the name is not that of a temporary file.
pub fn target_of_part(part: &Path) -> Option<PathBuf> {
    let target = target_name(part.file_name()?.as_encoded_bytes())?;
    Some(part.with_file_name(std::str::from_utf8(target).ok()?))
}

/// Returns the name between the dot and `.PID-N.part`.
fn target_name(part: &[u8]) -> Option<&[u8]> {
    let inner = part.strip_prefix(b".")?.strip_suffix(b".part")?;
    let dot = inner.iter().rposition(|byte| *byte == b'.')?;
    let is_number = |text: &[u8]| !text.is_empty() && text.iter().all(u8::is_ascii_digit);
    let (process, number) = std::str::from_utf8(&inner[dot + 1..]).ok()?.split_once('-')?;
    (is_number(process.as_bytes()) && is_number(number.as_bytes())).then_some(&inner[..dot])
}

/// Syncs the folder, where the system can, so that the new name survives a power cut. The content is already synced.
fn sync_folder(folder: &Path) {
    #[cfg(unix)]
    {
        _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
    #[cfg(not(unix))]
    {
        _ = folder;
    }
}

/// The folder of a file.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_tells_what_it_was_to_become() {
        let file = Path::new("folder/a.b.toml");
        assert_eq!(target_of_part(&part_of(file)).as_deref(), Some(file));
        for other in ["a.b.toml", ".a.part", ".a.1.part", ".a.1-.part", ".a.x-1.part", "a.1-2.part"]
        {
            assert_eq!(target_of_part(Path::new(other)), None, "{other}");
        }
    }

    #[test]
    fn only_what_is_surely_left_of_the_same_file_is_removed() {
        let folder = tempfile::tempdir().expect("a folder");
        let in_folder = |name: &str| folder.path().join(name);
        let target = in_folder("a.csv");
        for left in [".a.csv.4194999-0.part", ".a.csv.1-17.part"] {
            std::fs::write(in_folder(left), "half of i").expect("written");
        }
        let others = [".b.csv.7-0.part", ".a.csv.notes.part", ".a.csv.7-0.party", "a.csv.7-0.part"];
        for other in others {
            std::fs::write(in_folder(other), "theirs").expect("written");
        }
        std::fs::create_dir(in_folder(".a.csv.7-1.part")).expect("made");
        let living = Part::beside(&target).expect("begun");
        remove_left_of(&target);
        let mut left: Vec<PathBuf> = std::fs::read_dir(folder.path())
            .expect("a folder")
            .map(|entry| entry.expect("an entry").path())
            .collect();
        left.sort();
        let mut expected: Vec<PathBuf> = others.iter().map(|name| in_folder(name)).collect();
        expected.extend([in_folder(".a.csv.7-1.part"), living.path.clone()]);
        expected.sort();
        assert_eq!(left, expected);
    }
}
