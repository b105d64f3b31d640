//! Asking for a path: by the system's dialog where there is one ([`system`]), inside the window otherwise ([`PathPrompt`],
//! drawn by `panels/path_prompt.rs`). Both answer the same [`Question`].

mod listing;
mod prompt;
pub mod system;

pub use listing::{Entry, Listing};
pub use prompt::{PathPrompt, PromptCommand, PromptStep};

use std::path::PathBuf;
use std::sync::mpsc::Receiver;

/// The answer to a [`Question`], once there is one.
pub enum Answer {
    OfSystem(system::Asked),
    /// Sent by the prompt; it is dropped when the user cancels.
    OfWindow(Receiver<PathBuf>),
}

impl Answer {
    /// Waits for the user, so not for the thread that draws; `None` when the user cancels.
    pub fn wait(self) -> Option<PathBuf> {
        match self {
            Self::OfSystem(asked) => Some(pollster::block_on(asked)?.path().to_owned()),
            Self::OfWindow(receiver) => receiver.recv().ok(),
        }
    }
}

/// What is asked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Question {
    pub title: String,
    pub wanted: Wanted,
    /// Kinds of file that the system's dialog offers to show alone: name and extensions.
    pub kinds: &'static [(&'static str, &'static [&'static str])],
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// Something that is there. In the window it may be either; the system's dialog must know whether it is a folder.
    ToOpen { folder: bool },
    /// A file that was saved from here, as sessions and plans are: it is looked for where files were saved last.
    Saved,
    /// A folder to write into.
    Folder,
    /// A file to write, with the name that is proposed, and what is put behind a name that is typed without any ending.
    NewFile { name: String, extension: String },
}

impl Question {
    pub fn new(title: impl Into<String>, wanted: Wanted) -> Self {
        Self { title: title.into(), wanted, kinds: &[] }
    }

    pub fn kinds(self, kinds: &'static [(&'static str, &'static [&'static str])]) -> Self {
        Self { kinds, ..self }
    }

    /// A file to write, named after a deployment, which may be called anything.
    pub fn new_file(title: impl Into<String>, name: &str, extension: &str) -> Self {
        let name = name.replace(['/', '\\', ':'], "_");
        let name = format!("{name}.{extension}");
        Self::new(title, Wanted::NewFile { name, extension: extension.to_owned() })
    }
}
