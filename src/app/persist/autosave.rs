//! Saves the session of a running window every few seconds, for recovery after a crash.
//!
//! Each window has its own file, and locks a second file beside it while it runs. A file whose lock is free belongs to a window that
//! crashed: the next window that starts restores it. Session files of the user are never touched.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use super::damaged_file::keep_aside;
use super::hashes::HashCache;
use super::session::{Session, SessionError};
use super::session_file;
use super::writer::Writer;
use resect_core::deployment::Finding;
use resect_io::atomic;

/// Saves the session of this window in a file of its own.
pub struct Autosave {
    file: OwnFile,
    /// File of a crashed window, until its content is saved in this window's own file.
    taken_over: Arc<Mutex<Option<OwnFile>>>,
    writer: Writer,
    cache: Arc<HashCache>,
    /// The session saved last; `None` after a failure, so that the next offer writes again.
    last: Option<Session>,
    /// True if the user knows that the session cannot be written; reset by the next success.
    told: Arc<AtomicBool>,
}

/// The session of a crashed window.
pub struct Recovered {
    pub session: Session,
    pub findings: Vec<Finding>,
    /// When the session was last written.
    pub saved: Option<SystemTime>,
    file: OwnFile,
}

/// A locked session file. Dropping it releases the lock and keeps the file.
struct OwnFile {
    path: PathBuf,
    lock_path: PathBuf,
    _lock: File,
}

impl OwnFile {
    /// Locks a session file, which need not exist; `None` if another window has the lock.
    fn lock(path: PathBuf) -> std::io::Result<Option<Self>> {
        let lock_path = path.with_extension("lock");
        // Windows locks no file that is open for appending only.
        let lock = File::options().create(true).read(true).append(true).open(&lock_path)?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Ok(None),
            Err(TryLockError::Error(error)) => return Err(error),
        }
        // Another window may have removed the lock file between opening and locking; the lock would then protect nothing.
        Ok(lock_path.exists().then_some(Self { path, lock_path, _lock: lock }))
    }

    /// Removes the session before its lock: an unlocked session means that a window crashed.
    fn remove(&self) {
        _ = std::fs::remove_file(&self.path);
        _ = std::fs::remove_file(&self.lock_path);
    }
}

impl Autosave {
    /// Creates a session file in this folder, and returns the session of the window that crashed last, if there is one.
    pub fn start(
        folder: &Path,
        cache: Arc<HashCache>,
    ) -> std::io::Result<(Self, Option<Recovered>, Vec<Finding>)> {
        std::fs::create_dir_all(folder)?;
        let (recovered, findings) = newest_left(folder);
        let file = own_file(folder)?;
        let autosave = Self {
            file,
            taken_over: Arc::default(),
            writer: Writer::start("resect autosave"),
            cache,
            last: None,
            told: Arc::default(),
        };
        Ok((autosave, recovered, findings))
    }

    /// Adopts a crashed window's session. The old file remains until this window has saved the session in its own.
    pub fn take_over(&mut self, recovered: Recovered) -> (Session, Vec<Finding>) {
        put(&self.taken_over, Some(recovered.file));
        (recovered.session, recovered.findings)
    }

    /// Saves the session in the background if it differs from the last one; returns true if it does.
    pub fn offer(&mut self, session: Session) -> bool {
        if self.last.as_ref() == Some(&session) {
            return false;
        }
        let (path, cache) = (self.file.path.clone(), Arc::clone(&self.cache));
        let (written, taken_over) = (session.clone(), Arc::clone(&self.taken_over));
        let told = Arc::clone(&self.told);
        self.last = Some(session);
        self.writer.write(move || {
            if written.is_empty() {
                _ = std::fs::remove_file(&path);
            } else {
                written.save(&path, &cache).map_err(|error| error.to_string())?;
            }
            if let Some(old) = put(&taken_over, None) {
                old.remove();
            }
            told.store(false, Ordering::Relaxed);
            Ok(())
        });
        true
    }

    /// Returns the error of the last save, but only once until a save succeeds. After an error, the next session offered is written.
    pub fn take_error(&mut self) -> Option<String> {
        let error = self.writer.take_error()?;
        self.last = None;
        (!self.told.swap(true, Ordering::Relaxed)).then_some(error)
    }

    /// Closes the window and leaves the session, which could not be saved elsewhere, for the next window to restore.
    pub fn leave(mut self, session: Session) {
        self.cache.stop();
        self.offer(session);
        self.writer.finish();
    }

    /// Closes the window after its session was saved elsewhere, and leaves nothing to restore.
    pub fn finish(self) {
        self.cache.stop();
        self.writer.finish();
        if let Some(old) = put(&self.taken_over, None) {
            old.remove();
        }
        self.file.remove();
    }
}

/// Replaces a file, and returns the former one.
fn put(place: &Mutex<Option<OwnFile>>, file: Option<OwnFile>) -> Option<OwnFile> {
    std::mem::replace(&mut place.lock().unwrap_or_else(PoisonError::into_inner), file)
}

/// Creates a session file with an unused name.
fn own_file(folder: &Path) -> std::io::Result<OwnFile> {
    for number in 0..100 {
        let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let name = format!("{}-{}-{number}.toml", std::process::id(), since.as_nanos());
        let path = folder.join(name);
        if let Some(file) = OwnFile::lock(path)? {
            return Ok(file);
        }
    }
    Err(std::io::Error::other("no unused file name found"))
}

/// Locks and loads the newest session of a crashed window; older ones remain for the next windows.
fn newest_left(folder: &Path) -> (Option<Recovered>, Vec<Finding>) {
    let mut findings = Vec::new();
    let Ok(entries) = std::fs::read_dir(folder) else { return (None, findings) };
    let paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    remove_scraps(&paths);
    let changed = |path: &Path| path.metadata().and_then(|metadata| metadata.modified()).ok();
    let mut left: Vec<(Option<SystemTime>, &PathBuf)> = paths
        .iter()
        .filter(|path| path.extension().is_some_and(|end| end == "toml") && !is_hidden(path))
        .map(|path| (changed(path), path))
        .collect();
    left.sort_by(|a, b| b.cmp(a));
    for (saved, path) in left {
        let Ok(Some(file)) = OwnFile::lock(path.clone()) else { continue };
        match session_file::load(path) {
            Ok((session, of_session)) => {
                let recovered = Recovered { session, findings: of_session, saved, file };
                return (Some(recovered), findings);
            }
            // Another window may have taken it over and removed it just now.
            Err(SessionError::Read { error, .. })
                if error.kind() == std::io::ErrorKind::NotFound =>
            {
                file.remove();
            }
            Err(error) => {
                let why = format!("the session from before the crash cannot be restored: {error}");
                let (moved, finding) = keep_aside(path, &why);
                findings.push(finding);
                if moved {
                    file.remove();
                }
            }
        }
    }
    (None, findings)
}

/// Removes lock files without a session, and partly written files, of windows that ended.
fn remove_scraps(paths: &[PathBuf]) {
    for path in paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if let Some(session) = name.strip_suffix(".lock") {
            let session = path.with_file_name(format!("{session}.toml"));
            if !session.exists()
                && let Ok(Some(file)) = OwnFile::lock(session)
            {
                // Checks again under the lock, because its window may be about to write.
                if !file.path.exists() {
                    _ = std::fs::remove_file(&file.lock_path);
                }
            }
        } else if is_hidden(path)
            && let Some(session) = atomic::target_of_part(path)
            && let Ok(Some(file)) = OwnFile::lock(session)
        {
            _ = std::fs::remove_file(path);
            if !file.path.exists() {
                _ = std::fs::remove_file(&file.lock_path);
            }
        }
    }
}

fn is_hidden(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'))
}

#[cfg(test)]
#[path = "autosave_tests.rs"]
mod tests;
