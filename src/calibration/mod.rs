//! From triplets to the stations' extrinsics, each answer with its uncertainty and a verdict.
//!
//! [`solve`] is the one way in; the methods live in modules of their own. Today that is the paper's method D,
//! [`inter_prism`].

pub mod inter_prism;
mod settings;
mod verdict;

pub use settings::{CalibrationSettings, PriorMethod};
pub use verdict::Verdict;

use nalgebra::{SMatrix, Vector3};

use crate::deployment::{Deployment, Finding};
use crate::geometry::LevelTransform;
use crate::pipeline::Triplets;

/// The calibrations of the paper that the program knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// D: dynamic inter-prism.
    InterPrism,
}

impl Method {
    pub fn name(self) -> &'static str {
        match self {
            Self::InterPrism => "inter-prism",
        }
    }
}

/// Why there is no answer at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    #[error("{deployment}: no triplets: {why}")]
    NoTriplets { deployment: String, why: String },
    #[error(
        "{deployment}: only {found} triplets, {needed} needed for 8 unknowns; record longer, or relax the filters"
    )]
    TooFewTriplets { deployment: String, found: usize, needed: usize },
    #[error(
        "{deployment}: the inter-prism distances are not known; put calibration_results.csv beside the tracks, set \
         inter_prism_m in deployment.toml, or give --rig"
    )]
    NoRig { deployment: String },
}

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

/// What told a solution from its mirror twin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResolvedBy {
    /// Which prism stands higher on the vehicle.
    Rig,
    ControlPoints,
    /// Pitch and roll of the vehicle made the twin fit worse.
    Cost,
    /// Nothing: the answer is one of two.
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
    /// The answer: frames of stations 1 (identity), 2 and 3 into station 1's.
    pub basin: Basin,
    /// Of stations 2 and 3; `None` when the data leaves a direction free.
    pub sigma: Option<[TransformSigma; 2]>,
    /// Covariance of (x, y, z, yaw) of station 2, then of station 3 (m, rad).
    pub covariance: Option<SMatrix<f64, 8, 8>>,
    pub mirror: Mirror,
    pub verdict: Verdict,
    /// Why the verdict is what it is, and what else was noticed.
    pub findings: Vec<Finding>,
    /// What the search of the prior did, when it was asked for.
    pub prior_search: Option<inter_prism::PriorSearch>,
    /// Wall time of the prior and of the rest (ms).
    pub prior_ms: f64,
    pub solve_ms: f64,
}

impl Calibration {
    pub fn station1_from_station(&self) -> &[LevelTransform; 3] {
        &self.basin.station1_from_station
    }
}

/// Calibrates a deployment from its triplets by the method of the settings.
pub fn solve(
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
) -> Result<Calibration, CalibrationError> {
    inter_prism::solve(deployment, triplets, settings)
}
