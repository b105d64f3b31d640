//! What is said of a plan before it is driven.

use nalgebra::{SMatrix, Vector3};

use super::locks::Lock;
use crate::calibration::inter_prism::observability::Observability;
use crate::calibration::joint::Dominant;
use crate::calibration::{TransformSigma, Verdict};
use crate::deployment::Finding;
use crate::evaluation::far_end::FarEnd;

/// Why there is nothing to say of a plan.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanError {
    #[error("{what}; {remedy}")]
    Senseless { what: String, remedy: &'static str },
    #[error("all stations together read nothing for longer than {tau_l_s} s on this way; {remedy}")]
    NothingRead { tau_l_s: f64, remedy: &'static str },
}

/// What a planned drive will tell. Places are in the frame of the plan.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// How an answer from such a drive is to be trusted, as far as the drive decides it.
    pub verdict: Verdict,
    /// Why, and what else is to be known before.
    pub findings: Vec<Finding>,
    /// What is left open of the eight numbers; `None` where a direction stays free.
    pub held: Option<Held>,
    /// Which directions the drive holds, with arrows in the axes of the plan; `None` of one prism.
    pub observability: Option<Observability>,
    /// What the mirror twin costs over the answer; `None` of one prism, or where there is no twin.
    pub mirror_cost_ratio: Option<f64>,
    /// The vehicle along the way, about once a second.
    pub way: Vec<OnTheWay>,
    /// What each station meets while it follows its prism.
    pub locks: [Lock; 3],
    pub duration_s: f64,
    pub length_m: f64,
    /// Readings of each station, and how many of them the pipeline keeps.
    pub readings: [usize; 3],
    pub kept: [usize; 3],
}

/// What a drive leaves open of the eight numbers.
#[derive(Clone, Debug)]
pub struct Held {
    /// Of stations 2 and 3, along the axes of the plan.
    pub sigma: [TransformSigma; 2],
    /// Covariance of (x, y, z, yaw) of stations 2 and 3 (m, rad), along the axes of the plan.
    pub covariance: SMatrix<f64, 8, 8>,
    /// What most of each of these σ comes from.
    pub dominant: [Dominant; 8],
    pub far_end: FarEnd,
}

/// The vehicle at one instant of the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnTheWay {
    pub time_s: f64,
    /// The vehicle's origin.
    pub position_m: Vector3<f64>,
    /// Root mean square error of that (m) and of its rotation (rad); `None` where no motion is known, and for the rotation of one
    /// prism.
    pub position_sigma_m: Option<f64>,
    pub rotation_sigma_rad: Option<f64>,
}
