//! Hashes of input files: whether what a session was made from is still what lies there.

use std::collections::HashMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::deployment::{Deployment, Finding, Place, Source};

/// What a file was when it was read; `sha256sum` gives the same.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileMark {
    pub path: PathBuf,
    pub bytes: u64,
    pub sha256: String,
}

/// Hashes that were computed already; a file is read again only when its size or its time of change is another.
#[derive(Debug, Default)]
pub struct HashCache {
    known: Mutex<Known>,
    stopped: AtomicBool,
}

type Known = HashMap<PathBuf, (u64, SystemTime, String)>;

impl HashCache {
    fn known(&self) -> MutexGuard<'_, Known> {
        // Who panicked left hashes that are as good as any.
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The window is closed: what is not hashed yet is left out, and what is being hashed is given up.
    pub fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }

    /// Reads the whole file unless it is known. Takes a second for a few hundred MB: not on the window's thread.
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
                let sha256 = self.sha256(path)?;
                self.known().insert(path.to_owned(), (bytes, changed, sha256.clone()));
                sha256
            }
        };
        Ok(FileMark { path: path.to_owned(), bytes, sha256 })
    }

    /// One finding for each file that is not what it was.
    pub fn changed(&self, marks: &[FileMark]) -> Vec<Finding> {
        marks.iter().filter_map(|mark| self.change(mark)).collect()
    }

    fn change(&self, was: &FileMark) -> Option<Finding> {
        let name = was.path.display();
        match self.mark(&was.path) {
            Ok(now) if now == *was => None,
            Ok(now) => {
                let sizes = if now.bytes == was.bytes {
                    "the same size, other content".to_owned()
                } else {
                    format!("{} bytes, {} now", was.bytes, now.bytes)
                };
                Some(Finding::warning(format!(
                    "{name}: changed since the session was saved ({sizes}); the answer may be another"
                )))
            }
            Err(error) => Some(Finding::warning(format!(
                "{name}: was read when the session was saved, and cannot be now ({error})"
            ))),
        }
    }

    fn sha256(&self, path: &Path) -> std::io::Result<String> {
        let mut file = File::open(path)?;
        let mut hasher = Sha256::new();
        let mut buffer = vec![0; 1 << 16];
        loop {
            if self.stopped.load(Ordering::Relaxed) {
                return Err(std::io::Error::other("resect is being closed"));
            }
            match file.read(&mut buffer)? {
                0 => break,
                read => hasher.update(&buffer[..read]),
            }
        }
        Ok(hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
    }
}

/// The files that a deployment was read from; none of a sample.
pub fn used_files(source: &Source, deployment: &Deployment) -> Vec<PathBuf> {
    let Place::Path(path) = &source.place else { return Vec::new() };
    let folder =
        if path.is_dir() { path.as_path() } else { path.parent().unwrap_or(Path::new("")) };
    let extras = &source.extras;
    let named: Vec<&PathBuf> = extras.rig.iter().chain(&extras.gcp).chain(&extras.gnss).collect();
    let place = |file: &str| {
        // What the user named is told as it was named, or from the named folder on.
        let candidates = named.iter().map(|named| match named.is_dir() {
            true => named.join(file),
            false => (*named).clone(),
        });
        let own = folder.join(file);
        let mut named = candidates.filter(|path| path.ends_with(file) && path.is_file());
        if own.is_file() { Some(own) } else { named.next() }
    };
    let used = deployment.ingredients.iter().filter(|ingredient| ingredient.used);
    used.filter_map(|ingredient| place(&ingredient.file)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let said: Vec<&str> = findings.iter().map(|finding| finding.message.as_str()).collect();
        assert_eq!(said.len(), 3, "{said:?}");
        assert!(said[0].contains("longer") && said[0].contains("3 bytes, 4 now"), "{said:?}");
        assert!(said[1].contains("other") && said[1].contains("the same size"), "{said:?}");
        assert!(said[2].contains("gone") && said[2].contains("cannot be now"), "{said:?}");
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
