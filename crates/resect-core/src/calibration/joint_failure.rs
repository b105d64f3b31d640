//! Failures of the joint estimate, after which the published method answers.

use super::Method;
use super::joint::JointEstimate;
use crate::deployment::Finding;
use crate::deployment::findings::answers::{estimate_not_converged, joint_estimate_undetermined};

/// Reason why the published method answers instead of the joint estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointFailure {
    /// The iteration stopped before it reached a minimum.
    NotConverged,
    /// The readings do not determine all parameters.
    Undetermined,
}

impl JointFailure {
    /// Returns the reason in words: "the joint estimate did not converge".
    pub fn in_words(self) -> &'static str {
        match self {
            Self::NotConverged => "the joint estimate did not converge",
            Self::Undetermined => "the joint estimate is not determined",
        }
    }

    /// Returns the finding that `published` answers instead.
    pub fn finding(self, published: Method) -> Finding {
        let published = published.to_string();
        match self {
            Self::NotConverged => estimate_not_converged(&published),
            Self::Undetermined => joint_estimate_undetermined(&published),
        }
    }
}

/// A joint estimate that converged, or the reason why there is none.
pub type JointResult = Result<JointEstimate, JointFailure>;

/// Returns the estimate if it converged.
pub fn require_converged(estimate: Option<JointEstimate>) -> JointResult {
    match estimate {
        Some(estimate) if estimate.converged => Ok(estimate),
        Some(_) => Err(JointFailure::NotConverged),
        None => Err(JointFailure::Undetermined),
    }
}
