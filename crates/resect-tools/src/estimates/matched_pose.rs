//! Poses of an estimate, each with the ground truth at its time.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use resect_core::deployment::EstimatedPose;
use resect_core::statistics::median;

/// Ground truth at one instant, in its own frame: for a deployment, station 1's.
#[derive(Clone, Debug, PartialEq)]
pub struct TruePose {
    pub time_s: f64,
    pub position_m: Vector3<f64>,
    pub velocity_m_per_s: Vector3<f64>,
    /// `None` for a single prism or antenna, which has no orientation.
    pub rotation: Option<TrueRotation>,
    /// Covariance of the position (m²); `None` if the ground truth states no uncertainty.
    pub covariance_m2: Option<Matrix3<f64>>,
    /// Largest contradiction of the readings around the instant with the rig, or with each other if all are of one prism (m).
    /// No error of an estimate causes it. `None` for a trajectory, which has no redundant readings.
    pub contradiction_m: Option<f64>,
}

impl TruePose {
    /// Returns the motion (m/s, rad/s); the rate is zero without orientations.
    pub fn twist(&self) -> PoseTwist {
        let rate = self.rotation.as_ref().map(|rotation| rotation.rate_rad_per_s);
        PoseTwist {
            velocity_m_per_s: self.velocity_m_per_s,
            rate_rad_per_s: rate.unwrap_or_default(),
        }
    }
}

/// Orientation of the ground truth at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct TrueRotation {
    pub orientation: UnitQuaternion<f64>,
    pub rate_rad_per_s: Vector3<f64>,
    /// Covariance of the rotation vector (rad²), and its covariance with the position (rad m), rows the rotation.
    pub covariance_rad2: Option<Matrix3<f64>>,
    pub with_position: Matrix3<f64>,
}

/// A pose of an estimate and the ground truth at its time.
#[derive(Clone, Debug, PartialEq)]
pub struct MatchedPose {
    pub pose: EstimatedPose,
    pub truth: TruePose,
    /// Motion of the estimate, if it was interpolated at the ground truth's time. Otherwise the ground truth was interpolated.
    pub pose_twist: Option<PoseTwist>,
}

/// Velocity and rotation rate of a trajectory, in the frame of its poses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseTwist {
    pub velocity_m_per_s: Vector3<f64>,
    /// Zero without orientations.
    pub rate_rad_per_s: Vector3<f64>,
}

/// Readings are wrong if they contradict the rig by more than this multiple of the usual size, and by more than this length
/// (m).
const CONTRADICTED_TIMES: f64 = 4.0;
const CONTRADICTED_M: f64 = 0.01;

/// Largest contradiction of readings that are not wrong (m).
pub fn contradiction_limit_m<'a>(truths: impl Iterator<Item = &'a TruePose>) -> f64 {
    let usual_m = median(truths.filter_map(|truth| truth.contradiction_m)).unwrap_or_default();
    (CONTRADICTED_TIMES * usual_m).max(CONTRADICTED_M)
}

/// Pairs without those at which the readings are wrong. A ground truth that is metres off for some seconds says nothing about
/// an estimate's clock, lever arm and frame.
pub fn consistent(pairs: &[MatchedPose]) -> Vec<MatchedPose> {
    let limit_m = contradiction_limit_m(pairs.iter().map(|pair| &pair.truth));
    let is_consistent =
        |pair: &&MatchedPose| pair.truth.contradiction_m.is_none_or(|error_m| error_m <= limit_m);
    pairs.iter().filter(is_consistent).cloned().collect()
}
