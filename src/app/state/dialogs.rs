//! Dialogs, questions and sheets above the panes.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::mpsc::Sender;

use super::deployments::Then;
use crate::app::file_dialog::PathPrompt;
use crate::app::file_dialog::system::SystemDialog;
use crate::app::model::{Asked, Overlay};
use resect_io::source::Source;
use resect_io::what_is::Sorted;

#[derive(Default)]
pub struct Dialogs {
    /// The command palette, the shortcut sheet or the glossary.
    pub overlay: Overlay,
    /// The path dialog inside the window.
    pub prompt: Option<OpenPrompt>,
    /// Pending questions to the user, answered in turn.
    pub(super) asked: VecDeque<PendingQuestion>,
    /// Path dialogs are inside the window until this one is ready.
    pub system: SystemDialog,
    /// Folder of the last path chosen for opening.
    pub(super) last_folder_opened: Option<PathBuf>,
    /// Folder of the last path chosen for saving.
    pub(super) last_folder_saved: Option<PathBuf>,
    pub hovering: Hovering,
}

/// The path dialog inside the window, and the channel for its answer.
pub struct OpenPrompt {
    pub shown: PathPrompt,
    pub(super) answer: Sender<PathBuf>,
}

/// A question, and the reading that continues with its answer.
pub(super) struct PendingQuestion {
    pub asked: Asked,
    pub reading: Option<(Source, Then)>,
}

/// The files that last hovered over the window.
#[derive(Debug, Default)]
pub struct Hovering {
    pub paths: Vec<PathBuf>,
    /// The files by kind; `None` until the kinds are known.
    pub sorted: Option<Sorted>,
    /// Number of the request that determines the kinds.
    pub(super) asked: Option<u64>,
}
