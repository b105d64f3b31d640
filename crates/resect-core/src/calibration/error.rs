//! Errors of a calibration, with remedies.

use std::fmt;

use super::{Method, Offer};
use crate::deployment::findings::answers::{
    cancelled, method_lacks_data, neither_method, no_joint_estimate, no_rig, no_triplets,
    points_on_a_line, too_few_triplets,
};
use crate::deployment::{Deployment, Finding};
use crate::progress::Cancelled;

/// Reasons why there is no answer.
#[derive(Clone, Debug, PartialEq)]
pub enum CalibrationError {
    NoTriplets {
        deployment: String,
        why: String,
    },
    TooFewTriplets {
        deployment: String,
        found: usize,
        needed: usize,
    },
    NoRig {
        deployment: String,
    },
    Lacking {
        deployment: String,
        method: Method,
        lack: String,
    },
    PointsOnALine {
        deployment: String,
        method: Method,
    },
    NoJointEstimate {
        why: Box<CalibrationError>,
        published: Method,
    },
    /// The joint estimate failed, and the published method that answers instead failed as well.
    NeitherMethod {
        /// Why the joint estimate failed: "the joint estimate diverged".
        joint: String,
        why: Box<CalibrationError>,
    },
    /// The caller cancelled the calibration; not to be shown as an error.
    Cancelled,
}

impl std::error::Error for CalibrationError {}

impl fmt::Display for CalibrationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.finding().fmt(f)
    }
}

impl From<Cancelled> for CalibrationError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl CalibrationError {
    /// Returns the error that the data does not allow a method.
    pub(super) fn lacking(deployment: &Deployment, method: Method, offer: &Offer) -> Self {
        let lack = offer.lack(method).unwrap_or("points that determine a transform").to_owned();
        Self::Lacking { deployment: deployment.name.clone(), method, lack }
    }

    /// Returns true if more readings are all that is missing.
    pub fn wants_readings(&self) -> bool {
        match self {
            Self::NoTriplets { .. } | Self::TooFewTriplets { .. } => true,
            Self::NoJointEstimate { why, .. } | Self::NeitherMethod { why, .. } => {
                why.wants_readings()
            }
            _ => false,
        }
    }

    /// Returns the error as a finding, with its remedies.
    pub fn finding(&self) -> Finding {
        let in_full = |method: &Method| format!("{method} ({})", method.name());
        match self {
            Self::NoTriplets { deployment, why } => no_triplets(deployment, why),
            Self::TooFewTriplets { deployment, found, needed } => {
                too_few_triplets(deployment, *found, *needed)
            }
            Self::NoRig { deployment } => no_rig(deployment),
            Self::Lacking { deployment, method, lack } => {
                method_lacks_data(deployment, &in_full(method), lack)
            }
            Self::PointsOnALine { deployment, method } => {
                points_on_a_line(deployment, &in_full(method))
            }
            Self::NoJointEstimate { why, published } => {
                no_joint_estimate(why.finding(), [&published.to_string(), published.name()])
            }
            Self::NeitherMethod { joint, why } => neither_method(joint, why.finding()),
            Self::Cancelled => cancelled(),
        }
    }
}
