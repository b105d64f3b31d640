//! Hashes of input files, by which a session detects changed inputs.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

pub use resect_io::file_mark::{FileMark, used_files};

use crate::app::model::findings::{session_file_changed, session_file_missing};
use resect_core::deployment::Finding;
use resect_io::file_mark::sha256;

/// Cached hashes; a file is read again only if its size or modification time has changed.
#[derive(Debug, Default)]
pub struct HashCache {
    known: Mutex<HashByPath>,
    stopped: AtomicBool,
}

type HashByPath = HashMap<PathBuf, (u64, SystemTime, String)>;

impl HashCache {
    fn known(&self) -> MutexGuard<'_, HashByPath> {
        // The hashes are valid even after a thread panicked.
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Stops hashing when the window is closed: hashes in progress and missing ones are abandoned.
    pub fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }

    /// Returns size and hash of a file, which it reads unless the hash is cached. Takes a second for a few hundred MB, so not for the
    /// window's thread.
    pub fn mark(&self, path: &Path) -> std::io::Result<FileMark> {
        let metadata = path.metadata()?;
        let (bytes, changed) = (metadata.len(), metadata.modified()?);
        let known = self.known().get(path).cloned();
        let sha256 = match known {
            Some((known_bytes, known_time, sha256))
                if (known_bytes, known_time) == (bytes, changed) =>
            {
                sha256
            }
            _ => {
                let go_on = || !self.stopped.load(Ordering::Relaxed);
                let sha256 = sha256(path, go_on)?;
                self.known().insert(path.to_owned(), (bytes, changed, sha256.clone()));
                sha256
            }
        };
        Ok(FileMark { path: path.to_owned(), bytes, sha256 })
    }

    /// Returns one finding for each changed file.
    pub fn changed(&self, marks: &[FileMark]) -> Vec<Finding> {
        marks.iter().filter_map(|mark| self.change(mark)).collect()
    }

    fn change(&self, was: &FileMark) -> Option<Finding> {
        match self.mark(&was.path) {
            Ok(now) if now == *was => None,
            Ok(now) => Some(session_file_changed(&was.path, was.bytes, now.bytes)),
            Err(error) => Some(session_file_missing(&was.path, &error)),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::app::model::kinds;
    use std::fs::File;

    use super::*;
    use resect_core::deployment::{FindingKind, Subject};

    #[test]
    fn a_changed_and_a_missing_file_are_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = |name: &str| folder.path().join(name);
        for name in ["same", "longer", "other", "gone"] {
            std::fs::write(file(name), "abc").expect("written");
        }
        let cache = HashCache::default();
        let marks: Vec<_> = ["same", "longer", "other", "gone"]
            .map(|name| cache.mark(&file(name)).expect("readable"))
            .into();
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!((marks[0].bytes, marks[0].sha256.as_str()), (3, abc));
        std::fs::write(file("longer"), "abcd").expect("written");
        std::fs::write(file("other"), "abd").expect("written");
        let later = SystemTime::now() + std::time::Duration::from_secs(2);
        let touched = File::options().write(true).open(file("other")).expect("there");
        touched.set_modified(later).expect("set");
        std::fs::remove_file(file("gone")).expect("removed");
        let findings = cache.changed(&marks);
        let is = |index: usize, kind: FindingKind, name: &str| {
            let finding: &Finding = &findings[index];
            let path = file(name).display().to_string();
            assert_eq!((finding.kind, &finding.subject), (kind, &Some(Subject::File(path))));
        };
        assert_eq!(findings.len(), 3, "{findings:?}");
        is(0, kinds::SESSION_FILE_CHANGED, "longer");
        assert_eq!(
            [3.0, 4.0].map(Some),
            ["bytes_before", "bytes_now"].map(|n| findings[0].value(n))
        );
        is(1, kinds::SESSION_FILE_CHANGED, "other");
        is(2, kinds::SESSION_FILE_MISSING, "gone");
    }

    #[test]
    fn once_stopped_only_what_is_known_is_given() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = |name: &str| folder.path().join(name);
        for name in ["known", "new"] {
            std::fs::write(file(name), "abc").expect("written");
        }
        let cache = HashCache::default();
        let mark = cache.mark(&file("known")).expect("readable");
        cache.stop();
        assert_eq!(cache.mark(&file("known")).expect("known"), mark);
        assert!(cache.mark(&file("new")).is_err());
    }
}
