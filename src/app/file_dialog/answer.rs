//! The answer to a request for a path.

use std::path::PathBuf;
use std::sync::mpsc::Receiver;

use super::system;

/// The pending answer to a [`super::Question`].
pub enum Answer {
    OfSystem(system::DialogAnswer),
    /// Sent by the path dialog; dropped if the user cancels.
    OfWindow(Receiver<PathBuf>),
}

impl Answer {
    /// Waits for the user, so not for the thread that draws; `None` if the user cancels.
    pub fn wait(self) -> Option<PathBuf> {
        match self {
            Self::OfSystem(asked) => Some(pollster::block_on(asked)?.path().to_owned()),
            Self::OfWindow(receiver) => receiver.recv().ok(),
        }
    }
}
