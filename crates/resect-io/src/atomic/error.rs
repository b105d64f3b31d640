//! Why a file could not be written, and what helps.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::part::folder_of;

#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be {what}: {error}; {}", path.display(), self.remedy())]
pub struct WriteError {
    pub path: PathBuf,
    pub error: std::io::Error,
    /// What was to be done with it, in a word.
    what: &'static str,
}

impl WriteError {
    /// Why a file could not be written.
    pub fn of_file(path: &Path, error: std::io::Error) -> Self {
        Self { path: path.to_owned(), error, what: "written" }
    }

    /// Why a folder could not be made.
    pub fn of_folder(path: &Path, error: std::io::Error) -> Self {
        Self { path: path.to_owned(), error, what: "made" }
    }

    fn remedy(&self) -> String {
        let folder = folder_of(&self.path);
        let remedy = match self.error.kind() {
            _ if self.path.as_os_str().is_empty() => "the name is empty; give one",
            ErrorKind::NotFound if !folder.exists() => {
                return format!(
                    "there is no folder {}; make it, or name another",
                    folder.display()
                );
            }
            ErrorKind::IsADirectory => "this is a folder; name a file in it",
            ErrorKind::NotADirectory => {
                "a file is named as if it were a folder; name another folder"
            }
            ErrorKind::AlreadyExists => "a file has this name; name another folder",
            ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
                "name a folder and a file that you may write to"
            }
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
                "make room there, or name a place with more; what was there before is as it was"
            }
            ErrorKind::InvalidFilename => "name it shorter",
            _ => "name a folder that is there and that you may write to",
        };
        remedy.to_owned()
    }
}
