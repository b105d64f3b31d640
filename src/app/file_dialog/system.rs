//! The system's file dialog.

use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::{Question, Wanted};

/// The chosen path; `None` if the user cancels.
pub type DialogAnswer = Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>>;

/// Opens the system's dialog. Some systems require a call on the window's thread; the answer is awaited on another.
pub fn ask(question: &Question) -> DialogAnswer {
    let mut dialog = rfd::AsyncFileDialog::new().set_title(&question.title);
    for (name, extensions) in question.kinds {
        dialog = dialog.add_filter(*name, extensions);
    }
    if !question.kinds.is_empty() {
        dialog = dialog.add_filter("All files", &["*"]);
    }
    match &question.wanted {
        Wanted::ToOpen { folder: true } | Wanted::Folder => Box::pin(dialog.pick_folder()),
        Wanted::ToOpen { folder: false } | Wanted::Saved => Box::pin(dialog.pick_file()),
        Wanted::NewFile { name, .. } => Box::pin(dialog.set_file_name(name).save_file()),
    }
}

/// State of the system's dialog.
#[derive(Clone, Debug, Default)]
pub struct SystemDialog {
    is_ready: Arc<AtomicBool>,
}

impl SystemDialog {
    /// The dialog of this system. On Linux, another thread finds out if there is one.
    pub fn of_system() -> Self {
        let dialog = Self::default();
        let is_ready = Arc::clone(&dialog.is_ready);
        #[cfg(target_os = "linux")]
        std::thread::spawn(move || is_ready.store(super::linux::answers(), Ordering::Relaxed));
        #[cfg(not(target_os = "linux"))]
        is_ready.store(true, Ordering::Relaxed);
        dialog
    }

    /// Returns true if [`ask`] shows a dialog at once.
    pub fn is_ready(&self) -> bool {
        self.is_ready.load(Ordering::Relaxed)
    }
}
