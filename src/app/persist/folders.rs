//! Folders of preferences and sessions.

use std::path::{Path, PathBuf};

/// Environment variable with the folder that replaces the user's own folders.
const FOLDER_VARIABLE: &str = "RESECT_CONFIG_DIR";

/// Folders in which resect saves the user's data.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Folders {
    /// Folder of the preferences.
    pub config: PathBuf,
    /// Folder of the sessions of running windows.
    pub autosave: PathBuf,
}

impl Folders {
    /// Returns the system's folders for this user, or the one in `RESECT_CONFIG_DIR`; `None` on a system without a home directory.
    pub fn of_user() -> Option<Self> {
        if let Some(folder) = std::env::var_os(FOLDER_VARIABLE).filter(|name| !name.is_empty()) {
            return Some(Self::inside(Path::new(&folder)));
        }
        let folders = directories::ProjectDirs::from("", "", "resect")?;
        Some(Self {
            config: folders.config_dir().to_owned(),
            autosave: folders.data_local_dir().join("autosave"),
        })
    }

    /// File of the session that was open last.
    pub fn last(&self) -> PathBuf {
        self.autosave.with_file_name("last.toml")
    }

    /// All of them inside one folder.
    pub fn inside(folder: &Path) -> Self {
        Self { config: folder.to_owned(), autosave: folder.join("autosave") }
    }
}
