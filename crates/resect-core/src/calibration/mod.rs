//! The calibrations: they lead from triplets to the stations' extrinsics, with an uncertainty and a verdict each.
//!
//! [`solve()`] is the one way in; the paper's four methods live in modules of their own: A [`two_point`],
//! B [`static_gcp`], C [`dynamic_gcp`], D [`inter_prism`]. The joint estimate goes beyond them, and carries the paper's
//! answer with it. [`Offer`] says which methods the data allows.

mod checks;
mod clocks_in_words;
mod common_errors;
mod disagreement;
pub mod dynamic_gcp;
mod error;
mod estimate;
pub mod instrument;
pub mod inter_prism;
pub mod joint;
mod judgement;
mod method;
mod misfits;
mod moving_triplets;
mod numbers;
mod point_to_point;
mod sense;
mod settings;
mod solve;
pub mod static_gcp;
mod targets;
pub mod time_blocks;
mod track_clocks;
pub mod two_point;
mod unchecked;
mod verdict;
mod witness;

pub use disagreement::{Disagreement, disagreements, moved_m};
pub use error::CalibrationError;
pub use estimate::{Estimate, Quantity, SUPPORTED_SIGMAS};
pub use instrument::ErrorSizes;
pub use method::{Method, Offer};
pub use misfits::{distance_errors_m, each_distance_error_m};
pub use moving_triplets::{Clock, MovingTriplets, velocity_m_per_s, with_clocks};
pub use numbers::{CALIBRATION_NUMBERS, SIGMA_DISTANCES};
pub use settings::{Alignment, CalibrationSettings, PriorMethod};
pub use solve::{solve, solve_while};
pub use targets::Targets;
pub use verdict::Verdict;
pub use witness::Witness;

use std::borrow::Cow;

use nalgebra::{SMatrix, Vector3};

use crate::deployment::{Deployment, Finding, TrackFrame};
use crate::geometry::{LevelTransform, RigidTransform};
use crate::pipeline::Triplets;

/// One standard deviation of each number of a transform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransformSigma {
    pub translation_m: Vector3<f64>,
    pub yaw_rad: f64,
}

/// A minimum of the cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Basin {
    pub station1_from_station: [LevelTransform; 3],
    /// Mean squared inter-prism error (m²): the paper's `cost_function_2`.
    pub mean_square_m2: f64,
    /// How much higher prism 1 stands than prisms 2 and 3 in this solution, on average (m).
    pub height_differences_m: [f64; 2],
}

impl Basin {
    /// How far apart two solutions put a station, at most (m).
    pub fn apart_m(&self, other: &Self) -> f64 {
        self.station1_from_station
            .iter()
            .zip(&other.station1_from_station)
            .map(|(a, b)| (a.translation_m - b.translation_m).norm())
            .fold(0.0, f64::max)
    }
}

/// What told a solution from its mirror twin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResolvedBy {
    /// What is known of which prism stands higher on the vehicle.
    Rig,
    ControlPoints,
    /// Pitch and roll of the vehicle made the twin fit worse.
    Cost,
    /// Nothing told them apart: the answer is one of two.
    Nothing,
}

impl ResolvedBy {
    pub fn name(self) -> Option<&'static str> {
        match self {
            Self::Rig => Some("rig"),
            Self::ControlPoints => Some("control-points"),
            Self::Cost => Some("cost"),
            Self::Nothing => None,
        }
    }
}

/// The second solution of method D on level ground, and how it was told from the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// The twin, where it is a minimum of its own.
    pub twin: Option<Basin>,
    /// Cost of the twin over the cost of the answer.
    pub cost_ratio: Option<f64>,
    pub resolved_by: ResolvedBy,
}

/// An answer.
#[derive(Clone, Debug)]
pub struct Calibration {
    pub method: Method,
    /// Frames of stations 1 (identity), 2 and 3 into station 1's; level unless a rigid alignment was asked for.
    pub station1_from_station: [RigidTransform; 3],
    /// Standard deviations of the transforms of stations 2 and 3; `None` when the data leaves a direction free.
    pub sigma: Option<[TransformSigma; 2]>,
    /// Covariance of (x, y, z, yaw) of station 2, then of station 3 (m, rad).
    pub covariance: Option<SMatrix<f64, 8, 8>>,
    pub verdict: Verdict,
    /// Why the verdict is what it is, and what else was noticed.
    pub findings: Vec<Finding>,
    /// What could have contradicted it, and did not.
    pub checked_by: Vec<Witness>,
    /// Details of its method.
    pub details: Details,
    /// Beside a joint estimate, the paper's answer to the same data, checked and judged like any other. `None` if the
    /// paper's method has none, which a finding says.
    pub published: Option<Box<Calibration>>,
    /// Wall time of the prior and of the rest (ms).
    pub prior_ms: f64,
    pub solve_ms: f64,
}

/// Details of a joint estimate, for three prisms or for one.
#[derive(Clone, Debug)]
pub struct JointDetails {
    /// `None` where the data does not determine all unknowns; the answer is then that of the published method.
    pub estimate: Option<joint::JointEstimate>,
    pub targets: JointTargets,
}

/// Properties of the answer that depend on the number of prisms.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "its owner is in a box")]
pub enum JointTargets {
    /// Minima, mirror twin and observability on the corrected readings.
    ThreePrisms(inter_prism::InterPrismDetails),
    /// Alignment of the tracks that the estimate starts from.
    OnePrism(dynamic_gcp::DynamicGcpDetails),
}

/// Details of an answer by method.
#[derive(Clone, Debug)]
pub enum Details {
    TwoPoint(two_point::TwoPointDetails),
    StaticGcp(static_gcp::StaticGcpDetails),
    DynamicGcp(dynamic_gcp::DynamicGcpDetails),
    InterPrism(Box<inter_prism::InterPrismDetails>),
    Joint(Box<JointDetails>),
}

impl Calibration {
    /// Whether something that it does not rest on, and that tells a biased answer from a true one, agrees with it.
    pub fn is_independently_checked(&self) -> bool {
        self.checked_by.iter().any(|witness| witness.is_independent())
    }

    /// Where the tracks stand in station 1's frame: this answer's transforms, or `None` where it is about the stations'
    /// own frames and the tracks are in another.
    pub fn placing_tracks(&self, deployment: &Deployment) -> Option<&[RigidTransform; 3]> {
        let placed = deployment.track_frame == TrackFrame::Own || self.method.is_from_tracks();
        placed.then_some(&self.station1_from_station)
    }

    /// This answer's transforms for the control points, which the stations read in their own frames; `None` where it is
    /// about the frame of the tracks instead.
    pub fn placing_control_points(&self, deployment: &Deployment) -> Option<&[RigidTransform; 3]> {
        let placed = deployment.track_frame == TrackFrame::Own || !self.method.is_from_tracks();
        placed.then_some(&self.station1_from_station)
    }

    /// "good", "good, not independently checked", "weak" …
    pub fn verdict_in_words(&self) -> String {
        self.verdict.in_words(self.is_independently_checked())
    }

    /// Root mean square of the point errors of methods A, B and C, and of the tracks of one prism (m).
    pub fn fit_rms_m(&self) -> Option<f64> {
        match &self.details {
            Details::TwoPoint(details) => Some(details.rms_m()),
            Details::StaticGcp(details) => Some(details.rms_m),
            Details::DynamicGcp(details) => Some(details.rms_m),
            Details::InterPrism(_) => None,
            Details::Joint(details) => match &details.targets {
                JointTargets::ThreePrisms(_) => None,
                JointTargets::OnePrism(details) => Some(details.rms_m),
            },
        }
    }

    /// The triplets corrected by the joint estimate's clocks and instrument errors; `None` of other methods.
    pub fn corrected(&self, triplets: &Triplets) -> Option<Triplets> {
        Some(self.joint()?.corrected(Cow::Borrowed(triplets)))
    }

    /// Correlations of what [`Calibration::covariance`] is of, from −1 to 1.
    pub fn correlation(&self) -> Option<SMatrix<f64, 8, 8>> {
        let covariance = self.covariance?;
        let sigma = covariance.diagonal().map(|variance| variance.max(f64::MIN_POSITIVE).sqrt());
        Some(SMatrix::from_fn(|i, j| covariance[(i, j)] / (sigma[i] * sigma[j])))
    }

    /// Clocks of stations 2 and 3 against station 1, where they are estimated.
    pub fn clocks(&self) -> Option<[Clock; 2]> {
        Some(self.joint()?.clocks())
    }

    /// Offset (s) and drift (s/s) of the clocks of stations 2 and 3 against station 1, where they are estimated.
    pub fn clock_estimates(&self) -> Option<[(Estimate, Estimate); 2]> {
        let joint = self.joint()?;
        Some([0, 1].map(|slot| (joint.clock_offsets_s[slot], joint.clock_drifts[slot])))
    }

    /// The joint estimate; `None` of other methods, and where the data does not determine it.
    pub fn joint(&self) -> Option<&joint::JointEstimate> {
        match &self.details {
            Details::Joint(details) => details.estimate.as_ref(),
            _ => None,
        }
    }

    /// The details of method D, and of a joint estimate of three prisms.
    pub fn inter_prism(&self) -> Option<&inter_prism::InterPrismDetails> {
        match &self.details {
            Details::InterPrism(details) => Some(details),
            Details::Joint(details) => match &details.targets {
                JointTargets::ThreePrisms(details) => Some(details),
                JointTargets::OnePrism(_) => None,
            },
            _ => None,
        }
    }
}
