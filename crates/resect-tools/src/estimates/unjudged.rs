//! Reasons why an estimate cannot be judged.

use super::unfit::Unfit;
use crate::findings::studies::estimate_not_judged;
use resect_core::deployment::{Finding, Remedy};
use resect_core::evaluation::no_trajectory::NoTrajectory;

/// Reason why an estimate cannot be judged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unjudged {
    #[error(transparent)]
    NoReference(#[from] NoTrajectory),
    #[error("{name}: {why}")]
    Unfit { name: String, why: Unfit },
    /// Another convention explains why; messages of the findings.
    #[error("{0}")]
    OtherConvention(String),
}

impl Unjudged {
    /// Returns the reason as a finding with its remedies.
    pub fn finding(&self) -> Finding {
        let remedy = match self {
            Self::NoReference(NoTrajectory::OnePrism(_) | NoTrajectory::NoMotion(_)) => {
                Some(Remedy::JointEstimate)
            }
            Self::NoReference(NoTrajectory::NoRig(_)) => Some(Remedy::GiveRig),
            Self::NoReference(_) | Self::Unfit { .. } | Self::OtherConvention(_) => None,
        };
        estimate_not_judged(&self.to_string(), remedy)
    }
}
