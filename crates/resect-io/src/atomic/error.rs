//! The error of writing a file, with a remedy.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::part::folder_of;
use crate::windows::is_in_use;

#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be {what}: {error}; {}", path.display(), self.remedy())]
pub struct WriteError {
    pub path: PathBuf,
    pub error: std::io::Error,
    /// Past participle of the failed action: "written" or "created".
    what: &'static str,
}

impl WriteError {
    /// Error of a file that cannot be written.
    pub fn of_file(path: &Path, error: std::io::Error) -> Self {
        Self { path: path.to_owned(), error, what: "written" }
    }

    /// Error of a folder that cannot be created.
    pub fn of_folder(path: &Path, error: std::io::Error) -> Self {
        Self { path: path.to_owned(), error, what: "created" }
    }

    fn remedy(&self) -> String {
        let folder = folder_of(&self.path);
        let remedy = match self.error.kind() {
            _ if self.path.as_os_str().is_empty() => "the name is empty; give one",
            ErrorKind::NotFound if !folder.exists() => {
                return format!(
                    "folder {} does not exist; create it, or choose another",
                    folder.display()
                );
            }
            ErrorKind::IsADirectory => "this is a folder; give a file name in it",
            ErrorKind::NotADirectory => "the path uses a file as a folder; choose another folder",
            ErrorKind::AlreadyExists => "a file has this name; choose another folder",
            _ if is_in_use(&self.error) => "close the program that has the file open",
            // Windows refuses to replace a file that another program has open with the error of permissions.
            ErrorKind::PermissionDenied if cfg!(windows) && self.path.is_file() => {
                "close the program that has the file open, or choose a file with write permission"
            }
            ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
                "choose a folder and a file with write permission"
            }
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
                "free space there, or choose another disk; the previous content is unchanged"
            }
            ErrorKind::InvalidFilename => "choose a shorter name",
            _ => "choose an existing folder with write permission",
        };
        remedy.to_owned()
    }
}
