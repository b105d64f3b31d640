//! Poses that a convention leaves out: repeats of the one before, and those that were never set.

use nalgebra::{UnitQuaternion, Vector3};

use resect_core::deployment::{EstimatedPose, EstimatedTrajectory};

/// Part of a pose that is held until the next one is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeldPart {
    Pose,
    Position,
    Orientation,
}

impl HeldPart {
    /// Returns true if a pose has this part of the one before.
    pub fn is_repeat(self, before: &EstimatedPose, pose: &EstimatedPose) -> bool {
        let is_position = before.position_m == pose.position_m;
        let is_orientation = before.orientation == pose.orientation;
        match self {
            Self::Pose => is_position && is_orientation,
            Self::Position => is_position,
            Self::Orientation => is_orientation && pose.orientation.is_some(),
        }
    }

    /// Returns the plural for a message.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Pose => "poses",
            Self::Position => "positions",
            Self::Orientation => "orientations",
        }
    }

    /// Returns the word of a convention that leaves out the repeats.
    pub fn word(self) -> &'static str {
        match self {
            Self::Pose => "held",
            Self::Position => "held=positions",
            Self::Orientation => "held=orientations",
        }
    }
}

/// Returns true if a pose is at the origin without rotation, as before it is set.
pub fn is_unset(pose: &EstimatedPose) -> bool {
    let is_identity = |orientation: UnitQuaternion<f64>| orientation == UnitQuaternion::identity();
    pose.position_m == Vector3::zeros() && pose.orientation.is_none_or(is_identity)
}

/// Leaves out the poses for which a condition on the one before and on the pose is true, with their covariances.
pub fn leave_out(
    estimate: &mut EstimatedTrajectory,
    is_left_out: impl Fn(Option<&EstimatedPose>, &EstimatedPose) -> bool,
) {
    let poses = std::mem::take(&mut estimate.poses);
    let keep: Vec<bool> = (0..poses.len())
        .map(|index| !is_left_out(index.checked_sub(1).map(|before| &poses[before]), &poses[index]))
        .collect();
    let kept = |index: &usize| keep[*index];
    estimate.poses = (0..poses.len()).filter(kept).map(|index| poses[index]).collect();
    if !estimate.covariances.is_empty() {
        let covariances = &estimate.covariances;
        estimate.covariances =
            (0..poses.len()).filter(kept).map(|index| covariances[index]).collect();
    }
}
