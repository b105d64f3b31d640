//! The session that was open last, before another session replaced it or the window was closed. One file serves all windows, and the File
//! menu opens it again.

use std::path::{Path, PathBuf};

use super::session::{Session, SessionError};

#[derive(Clone, Debug)]
pub struct LastSession {
    path: PathBuf,
    is_there: bool,
}

impl LastSession {
    /// The session in this file, which need not exist.
    pub fn at(path: PathBuf) -> Self {
        let is_there = path.is_file();
        Self { path, is_there }
    }

    /// The session's file; `None` if it does not exist.
    pub fn path(&self) -> Option<&Path> {
        Some(self.path.as_path()).filter(|_| self.is_there)
    }

    /// Records that this window has written the file.
    pub fn written(&mut self) {
        self.is_there = true;
    }

    /// Replaces the saved session, unless the new one is empty. Reads none of the inputs.
    pub fn write(&self, session: &Session) -> Result<(), SessionError> {
        if session.is_empty() {
            return Ok(());
        }
        session.save_unhashed(&self.path)
    }
}
