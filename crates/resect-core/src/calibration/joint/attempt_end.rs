//! The end of an attempt of the joint estimate without a result.

use super::solver_status::SolverStatus;
use crate::progress::Cancelled;

/// Reason why an attempt has no estimate.
pub enum AttemptEnd {
    Cancelled,
    Failed(SolverStatus),
}

/// Returns the end of an attempt whose normal matrix is not positive definite.
pub fn not_definite() -> AttemptEnd {
    SolverStatus::NotDefinite.into()
}

impl From<Cancelled> for AttemptEnd {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<SolverStatus> for AttemptEnd {
    fn from(status: SolverStatus) -> Self {
        Self::Failed(status)
    }
}
