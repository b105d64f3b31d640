//! Why a calibration has no answer, and what can be done about it.

use super::{Method, Offer};
use crate::deployment::{Deployment, Finding, Remedy};
use crate::progress::Cancelled;

/// Why there is no answer at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    #[error("{deployment}: no triplets: {why}")]
    NoTriplets { deployment: String, why: String },
    #[error(
        "{deployment}: only {found} triplets, {needed} needed for 8 unknowns; record longer, or relax the filters"
    )]
    TooFewTriplets { deployment: String, found: usize, needed: usize },
    #[error("{}", self.finding())]
    NoRig { deployment: String },
    #[error("{deployment}: {method} ({}) needs {lack}", .method.name())]
    Lacking { deployment: String, method: Method, lack: String },
    #[error(
        "{deployment}: the points of {method} ({}) lie in one place or on a line, which holds no rigid transform; \
         use a level alignment, or more points",
        .method.name()
    )]
    PointsOnALine { deployment: String, method: Method },
    #[error("{}", self.finding())]
    NoJointEstimate { why: Box<CalibrationError>, published: Method },
    /// The calibration was cancelled by who asked for it: not to be shown as an error.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for CalibrationError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl CalibrationError {
    /// A method that the data does not allow.
    pub(super) fn lacking(deployment: &Deployment, method: Method, offer: &Offer) -> Self {
        let lack = offer.lack(method).unwrap_or("points that hold a transform").to_owned();
        Self::Lacking { deployment: deployment.name.clone(), method, lack }
    }

    /// Whether nothing but more readings is wanting.
    pub fn wants_readings(&self) -> bool {
        match self {
            Self::NoTriplets { .. } | Self::TooFewTriplets { .. } => true,
            Self::NoJointEstimate { why, .. } => why.wants_readings(),
            _ => false,
        }
    }

    /// The error as a finding, with what can be done about it.
    pub fn finding(&self) -> Finding {
        match self {
            Self::NoRig { deployment } => Finding::problem(format!(
                "{deployment}: the inter-prism distances are not known; put calibration_results.csv beside the tracks, set \
                 inter_prism_m in deployment.toml, or name a file of the rig"
            ))
            .with(Remedy::GiveRig),
            Self::NoTriplets { .. } | Self::TooFewTriplets { .. } => {
                Finding::problem(self.to_string()).with(Remedy::RelaxFilters)
            }
            Self::PointsOnALine { .. } => {
                Finding::problem(self.to_string()).with(Remedy::LevelAlignment)
            }
            Self::NoJointEstimate { why, published } => {
                let why = why.finding();
                let message = format!(
                    "{}; {published} has an answer: choose it ({})",
                    why.message,
                    published.name()
                );
                let finding = Finding::problem(message).with(Remedy::PublishedMethod);
                why.remedies.into_iter().fold(finding, Finding::with)
            }
            Self::Lacking { .. } | Self::Cancelled => Finding::problem(self.to_string()),
        }
    }
}
