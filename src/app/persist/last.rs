//! What was open last, before another session took its place or the window was closed: one file for all windows,
//! which the File menu opens again.

use std::path::{Path, PathBuf};

use super::session::{Session, SessionError};

#[derive(Clone, Debug)]
pub struct LastSession {
    path: PathBuf,
    is_there: bool,
}

impl LastSession {
    /// The session that is kept in this file, there or not.
    pub fn at(path: PathBuf) -> Self {
        let is_there = path.is_file();
        Self { path, is_there }
    }

    /// The session's file, if there is one.
    pub fn path(&self) -> Option<&Path> {
        Some(self.path.as_path()).filter(|_| self.is_there)
    }

    /// Remembers that this window has written it.
    pub fn written(&mut self) {
        self.is_there = true;
    }

    /// Puts a session in the place of the one kept, unless nobody would miss it. Reads none of the inputs.
    pub fn write(&self, session: &Session) -> Result<(), SessionError> {
        if session.is_empty() {
            return Ok(());
        }
        session.save_unhashed(&self.path)
    }
}
