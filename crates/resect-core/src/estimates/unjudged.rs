//! Reasons why an estimate cannot be judged.

use super::unfit::Unfit;
use crate::deployment::findings::studies::estimate_not_judged;
use crate::deployment::{Finding, Remedy};
use crate::evaluation::vehicle::NoTrajectory;

/// Why an estimate cannot be judged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unjudged {
    #[error(transparent)]
    NoReference(#[from] NoTrajectory),
    #[error("{name}: {why}")]
    Unfit { name: String, why: Unfit },
}

impl Unjudged {
    /// The same as a finding with what can be done about it.
    pub fn finding(&self) -> Finding {
        let remedy = match self {
            Self::NoReference(NoTrajectory::OnePrism(_) | NoTrajectory::NoMotion(_)) => {
                Some(Remedy::JointEstimate)
            }
            Self::NoReference(NoTrajectory::NoRig(_)) => Some(Remedy::GiveRig),
            Self::NoReference(_) | Self::Unfit { .. } => None,
        };
        estimate_not_judged(&self.to_string(), remedy)
    }

    /// The flag, or the command, that does what is advised where there is no window with fields for it.
    pub fn flag(&self) -> Option<&'static str> {
        match self {
            Self::NoReference(why) => why.flag(),
            Self::Unfit { why, .. } => why.flag(),
        }
    }
}
