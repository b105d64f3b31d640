//! The session of a running window, written every few seconds, so that nothing is lost when the program stops.
//!
//! Each window has a file of its own and holds a lock beside it while it lives. A file whose lock can be had belonged
//! to a window that died: the next one that starts restores it. The user's own session files are never touched.

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

/// Keeps the session of this window in a file of its own.
pub struct Autosave {
    file: OwnFile,
    /// A dead window's file, until what it held is in this window's own.
    taken_over: Arc<Mutex<Option<OwnFile>>>,
    writer: Writer,
    cache: Arc<HashCache>,
    /// What was offered last; none after a failure, so that it is tried again.
    last: Option<Session>,
    /// Whether the user knows that it cannot be written, since when it last could.
    told: Arc<AtomicBool>,
}

/// What a window that died had open.
pub struct Recovered {
    pub session: Session,
    pub findings: Vec<Finding>,
    /// When the session was last written.
    pub saved: Option<SystemTime>,
    file: OwnFile,
}

/// A session's file with the lock that makes it one's own. Dropping it lets go of the lock and leaves the file.
struct OwnFile {
    path: PathBuf,
    lock_path: PathBuf,
    _lock: File,
}

impl OwnFile {
    /// Locks a session's file, there or not; none if another window holds it.
    fn lock(path: PathBuf) -> std::io::Result<Option<Self>> {
        let lock_path = path.with_extension("lock");
        let lock = File::options().create(true).append(true).open(&lock_path)?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Ok(None),
            Err(TryLockError::Error(error)) => return Err(error),
        }
        // A window that cleans up may have removed it between opening and locking: then the lock is of no file.
        Ok(lock_path.exists().then_some(Self { path, lock_path, _lock: lock }))
    }

    /// The file first: a lock without a file is nothing, a file without a lock is a dead window's.
    fn remove(&self) {
        _ = std::fs::remove_file(&self.path);
        _ = std::fs::remove_file(&self.lock_path);
    }
}

impl Autosave {
    /// Takes a file of its own in this folder, and what the window that died last left there.
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

    /// Makes a dead window's session this one's; its file stays until the session, which is this window's now, is written anew.
    pub fn take_over(&mut self, recovered: Recovered) -> (Session, Vec<Finding>) {
        put(&self.taken_over, Some(recovered.file));
        (recovered.session, recovered.findings)
    }

    /// Has the session written in the background where it is another than last time; whether it is.
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

    /// Why the last writing failed; once, however often it fails again. The next session offered is written then.
    pub fn take_error(&mut self) -> Option<String> {
        let error = self.writer.take_error()?;
        self.last = None;
        (!self.told.swap(true, Ordering::Relaxed)).then_some(error)
    }

    /// The window is closed, and this could not be kept elsewhere: the next window restores it.
    pub fn leave(mut self, session: Session) {
        self.cache.stop();
        self.offer(session);
        self.writer.finish();
    }

    /// The window is closed by its user and what was open is kept elsewhere: nothing is left to be restored.
    pub fn finish(self) {
        self.cache.stop();
        self.writer.finish();
        if let Some(old) = put(&self.taken_over, None) {
            old.remove();
        }
        self.file.remove();
    }
}

/// Puts a file in the place of another, which it gives.
fn put(place: &Mutex<Option<OwnFile>>, file: Option<OwnFile>) -> Option<OwnFile> {
    std::mem::replace(&mut place.lock().unwrap_or_else(PoisonError::into_inner), file)
}

/// A file of a name that nothing else has.
fn own_file(folder: &Path) -> std::io::Result<OwnFile> {
    for number in 0..100 {
        let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let name = format!("{}-{}-{number}.toml", std::process::id(), since.as_nanos());
        let path = folder.join(name);
        if let Some(file) = OwnFile::lock(path)? {
            return Ok(file);
        }
    }
    Err(std::io::Error::other("no file of its own to be had"))
}

/// The newest session that a dead window left, locked; older ones stay for the windows that start next.
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
                let why = format!("what was open when resect stopped cannot be restored: {error}");
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

/// Locks without a session, and half-written files, of windows that are gone.
fn remove_scraps(paths: &[PathBuf]) {
    for path in paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if let Some(session) = name.strip_suffix(".lock") {
            let session = path.with_file_name(format!("{session}.toml"));
            if !session.exists()
                && let Ok(Some(file)) = OwnFile::lock(session)
            {
                // Under its lock once more: its window may be about to write.
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
