//! Folders of the preferences and the sessions.

use std::path::{Path, PathBuf};

/// Says where everything is kept instead of in the user's own folders.
const FOLDER_VARIABLE: &str = "RESECT_CONFIG_DIR";

/// Where resect keeps what is the user's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Folders {
    /// The folder of the preferences.
    pub config: PathBuf,
    /// The folder of the sessions of running windows.
    pub autosave: PathBuf,
}

impl Folders {
    /// The system's folders for this user, or the one that `RESECT_CONFIG_DIR` names; none on a system without a home.
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

    /// All inside one folder.
    pub fn inside(folder: &Path) -> Self {
        Self { config: folder.to_owned(), autosave: folder.join("autosave") }
    }
}
