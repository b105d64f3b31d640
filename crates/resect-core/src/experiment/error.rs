//! Why a study gives no result.

use crate::progress::Cancelled;

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StudyError {
    /// The study was cancelled by who asked for it.
    #[error("cancelled")]
    Cancelled,
    #[error("{0}")]
    Nothing(String),
}

impl From<Cancelled> for StudyError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}
