//! Failures of the joint estimate, after which the published method answers.

use super::joint::{JointEstimate, SolverStatus, Trace};
use super::{CalibrationError, Method};
use crate::deployment::Finding;
use crate::deployment::findings::answers::{
    estimate_diverged, estimate_not_converged, joint_estimate_undetermined, no_common_readings,
    priors_tightened,
};

/// Reason why the published method answers instead of the joint estimate.
#[derive(Clone, Debug, PartialEq)]
pub struct JointFailure {
    /// Trace of the iteration, with the status that is the reason.
    pub trace: Trace,
}

impl JointFailure {
    /// A failure before the first step.
    pub fn before_first_step(status: SolverStatus) -> Self {
        Self { trace: Trace { status, ..Trace::default() } }
    }

    /// Returns the reason.
    pub fn status(&self) -> SolverStatus {
        self.trace.status
    }

    /// Returns true if the iteration did not end at a minimum.
    pub fn is_unconverged(&self) -> bool {
        matches!(self.status(), SolverStatus::TooManySteps | SolverStatus::Diverged)
    }

    /// Returns the reason in words: "the joint estimate did not converge".
    pub fn in_words(&self) -> String {
        format!("the joint estimate {}", self.status().in_words())
    }

    /// Returns the error that the published method has no answer either.
    pub fn without_published(&self, why: CalibrationError) -> CalibrationError {
        match why {
            CalibrationError::Cancelled => why,
            _ => CalibrationError::NeitherMethod { joint: self.in_words(), why: Box::new(why) },
        }
    }

    /// Returns the finding that `published` answers instead.
    pub fn finding(&self, published: Method) -> Finding {
        let published = published.to_string();
        match self.status() {
            SolverStatus::Diverged => estimate_diverged(&published),
            SolverStatus::NoReadings => no_common_readings(&published),
            SolverStatus::NotDefinite | SolverStatus::UnobservableStart => {
                joint_estimate_undetermined(&published)
            }
            SolverStatus::StifferPriors => priors_tightened(&published),
            SolverStatus::TooManySteps | SolverStatus::Converged => {
                estimate_not_converged(&published)
            }
        }
    }
}

impl From<Trace> for JointFailure {
    fn from(trace: Trace) -> Self {
        Self { trace }
    }
}

/// A joint estimate that converged, or the reason why there is none.
pub type JointResult = Result<JointEstimate, JointFailure>;
