//! What outlives the window: preferences, sessions, and what was open when the program stopped.
//!
//! Plain data and plain functions. [`session`] and [`preferences`] are the files, [`hashes`] tells whether inputs
//! changed, [`autosave`] keeps the running window's session safe, [`last`] what was open before, [`writer`] writes without a frame waiting, and
//! [`super::keeping`] is all that a window needs of it.

pub mod autosave;
pub mod hashes;
pub mod last;
pub mod preferences;
pub mod session;
pub mod session_file;
mod stored;
mod writer;

use std::path::{Path, PathBuf};

use crate::app::model::findings::unusable_file_kept;
use resect_core::deployment::Finding;

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

/// Moves a file that cannot be used out of the way of the one that will be written; whether it could, and what to
/// say. One that stays where it is must not be written over.
fn keep_aside(path: &Path, why: &str) -> (bool, Finding) {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let free = (1..1000)
        .map(|number| match number {
            1 => path.with_file_name(format!("{name}.bak")),
            _ => path.with_file_name(format!("{name}.{number}.bak")),
        })
        .find(|kept| !kept.exists());
    let moved = free.and_then(|kept| std::fs::rename(path, &kept).ok().map(|()| kept));
    (moved.is_some(), unusable_file_kept(why, moved.as_deref()))
}

/// Line of a byte of a text, from 1.
fn line_of(text: &str, byte: usize) -> usize {
    1 + text.bytes().take(byte).filter(|byte| *byte == b'\n').count()
}
