//! Prediction for a plan before it is driven.

use nalgebra::{DMatrix, Vector3};

use super::locks::Lock;
use resect_core::calibration::inter_prism::observability::Observability;
use resect_core::calibration::joint::LargestSource;
use resect_core::calibration::{TransformSigma, Verdict};
use resect_core::deployment::Finding;
use resect_core::evaluation::far_end::FarEnd;
use resect_core::network::PerStation;

/// Reason for which a plan has no prediction.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanError {
    #[error("{what}; {remedy}")]
    Senseless { what: String, remedy: &'static str },
    #[error("the stations never track together for longer than {tau_l_s} s on this path; {remedy}")]
    NothingRead { tau_l_s: f64, remedy: &'static str },
}

/// Prediction for a planned drive. Positions are in the frame of the plan.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// Verdict on a calibration from such a drive, as far as it depends on the drive.
    pub verdict: Verdict,
    /// Reasons for the verdict, and further findings.
    pub findings: Vec<Finding>,
    /// Predicted covariance of the transforms; `None` if a direction is unobservable.
    pub held: Option<Held>,
    /// Observability of directions, with arrows in the axes of the plan; `None` with one prism.
    pub observability: Option<Observability>,
    /// Cost of the mirror twin over that of the solution; `None` with one prism, or without a twin.
    pub mirror_cost_ratio: Option<f64>,
    /// The vehicle along the path, about once a second.
    pub way: Vec<OnTheWay>,
    /// Ranges, rates and failures of each station's tracking.
    pub locks: PerStation<Lock>,
    pub duration_s: f64,
    pub length_m: f64,
    /// Number of readings of each station, and of those that the pipeline keeps.
    pub readings: PerStation<usize>,
    pub kept: PerStation<usize>,
}

/// Predicted covariance of the transforms of stations 2, 3, …
#[derive(Clone, Debug)]
pub struct Held {
    /// Standard deviations along the axes of the plan, zeros for station 1.
    pub sigma: PerStation<TransformSigma>,
    /// Covariance of (x, y, z, yaw) of stations 2, 3, … (m, rad), along the axes of the plan.
    pub covariance: DMatrix<f64>,
    /// Largest source of each σ of that covariance.
    pub dominant: Vec<LargestSource>,
    pub far_end: FarEnd,
}

/// The vehicle at one instant of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnTheWay {
    pub time_s: f64,
    /// Position of the vehicle's origin.
    pub position_m: Vector3<f64>,
    /// Root mean square error of the position (m) and of the rotation (rad). `None` if no motion is estimated, and for the
    /// rotation with one prism.
    pub position_sigma_m: Option<f64>,
    pub rotation_sigma_rad: Option<f64>,
}
