//! The answer to a question for a path.

use std::path::PathBuf;
use std::sync::mpsc::Receiver;

use super::system;

/// The answer to a [`super::Question`], once there is one.
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
