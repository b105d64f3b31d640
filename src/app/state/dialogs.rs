//! Dialogs, questions and sheets above the panes.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::mpsc::Sender;

use super::deployments::Then;
use crate::app::file_dialog::{self, PathPrompt};
use crate::app::model::{Asked, Overlay};
use resect_io::source::Source;
use resect_io::what_is::Sorted;

pub struct Dialogs {
    /// The command palette, the sheet of shortcuts or the glossary.
    pub overlay: Overlay,
    /// The dialog for a path inside the window.
    pub prompt: Option<OpenPrompt>,
    /// Questions to the user, one after the other.
    pub(super) asked: VecDeque<PendingQuestion>,
    /// Whether paths are asked for inside the window: the system has no dialog.
    pub asks_in_window: bool,
    /// Folder of the last path that was chosen to open something.
    pub(super) last_folder_opened: Option<PathBuf>,
    /// Folder of the last path that was chosen to save something.
    pub(super) last_folder_saved: Option<PathBuf>,
    pub hovering: Hovering,
}

impl Default for Dialogs {
    fn default() -> Self {
        Self {
            overlay: Overlay::None,
            prompt: None,
            asked: VecDeque::new(),
            asks_in_window: !file_dialog::system::is_there(),
            last_folder_opened: None,
            last_folder_saved: None,
            hovering: Hovering::default(),
        }
    }
}

/// The dialog for a path inside the window, and the channel of its answer.
pub struct OpenPrompt {
    pub shown: PathPrompt,
    pub(super) answer: Sender<PathBuf>,
}

/// A question, and the reading that continues with its answer.
pub(super) struct PendingQuestion {
    pub asked: Asked,
    pub reading: Option<(Source, Then)>,
}

/// Files that hovered over the window last.
#[derive(Debug, Default)]
pub struct Hovering {
    pub paths: Vec<PathBuf>,
    /// Their kinds, once they are known.
    pub sorted: Option<Sorted>,
    /// Number of the request that finds it out.
    pub(super) asked: Option<u64>,
}
