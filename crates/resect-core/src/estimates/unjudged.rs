//! Reasons why an estimate cannot be judged.

use super::unfit::Unfit;
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
        let finding = Finding::problem(format!("not judged: {self}"));
        match self {
            Self::NoReference(NoTrajectory::OnePrism(_) | NoTrajectory::NoMotion(_)) => {
                finding.with(Remedy::JointEstimate)
            }
            Self::NoReference(NoTrajectory::NoRig(_)) => finding.with(Remedy::GiveRig),
            Self::NoReference(_) | Self::Unfit { .. } => finding,
        }
    }

    /// The flag, or the command, that does what is advised where there is no window with fields for it.
    pub fn flag(&self) -> Option<&'static str> {
        match self {
            Self::NoReference(why) => why.flag(),
            Self::Unfit { why, .. } => why.flag(),
        }
    }
}
