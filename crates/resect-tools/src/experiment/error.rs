//! Reasons why a study has no result.

use resect_core::progress::Cancelled;

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StudyError {
    /// The caller cancelled the study.
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
