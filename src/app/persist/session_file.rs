//! Reading and writing of session files.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::damaged_file::line_of;
use super::hashes::{FileMark, HashCache};
use super::session::{Files, Session, SessionError};
use super::stored;
use resect_core::deployment::Finding;
use resect_io::atomic;
use resect_io::windows;

impl Session {
    /// Text of a session file in this folder. Paths below the folder are relative, so that both can be moved together.
    pub fn text(&self, folder: &Path, cache: &HashCache) -> Result<String, SessionError> {
        self.text_with(folder, |files| files.marks(cache))
    }

    fn text_with(
        &self,
        folder: &Path,
        marks: impl Fn(&Files) -> &[FileMark],
    ) -> Result<String, SessionError> {
        toml::to_string(&stored::StoredSession::new(self, folder, marks))
            .map_err(|error| SessionError::Text(error.to_string()))
    }

    /// Writes the file, or leaves the old one unchanged on an error. Computes missing hashes, so not for the window's thread.
    pub fn save(&self, path: &Path, cache: &HashCache) -> Result<(), SessionError> {
        let text = self.text(&folder_of(path), cache)?;
        Ok(atomic::write(path, text)?)
    }

    /// Saves the session with the hashes known so far, reading no input.
    pub fn save_unhashed(&self, path: &Path) -> Result<(), SessionError> {
        let text = self.text_with(&folder_of(path), Files::known_marks)?;
        Ok(atomic::write(path, text)?)
    }
}

/// Returns a session and findings about ignored fields, or an error with location and remedy.
pub fn load(path: &Path) -> Result<(Session, Vec<Finding>), SessionError> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| SessionError::Read { path: path.to_owned(), error })?;
    let version: stored::Version = parse(path, &text)?;
    if version.resect_session > stored::VERSION {
        return Err(SessionError::Newer { path: path.to_owned(), by: version.resect });
    }
    let session: stored::StoredSession = parse(path, &text)?;
    session
        .read(&folder_of(path))
        .map_err(|what| SessionError::Content { path: path.to_owned(), what })
}

fn parse<T: for<'a> Deserialize<'a>>(path: &Path, text: &str) -> Result<T, SessionError> {
    toml::from_str(text).map_err(|error| {
        let line = error.span().map_or(1, |span| line_of(text, span.start));
        // The message is joined to one line.
        let what = error.message().lines().collect::<Vec<_>>().join(", ");
        SessionError::Line { path: path.to_owned(), line, what }
    })
}

/// The folder of a file, absolute if possible.
fn folder_of(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    windows::canonical(&folder).unwrap_or(folder)
}

#[cfg(test)]
#[path = "session_tests.rs"]
mod tests;
