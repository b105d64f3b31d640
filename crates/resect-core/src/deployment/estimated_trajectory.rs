//! A trajectory of another system.

use std::path::PathBuf;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::finding::Finding;
use super::names::told_apart;
use crate::geometry::Geodetic;

/// A trajectory estimated by another system.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimatedTrajectory {
    /// File name without its extension, with further words if needed to be unique.
    pub name: String,
    pub path: PathBuf,
    /// Topic in a bag of several trajectories; `None` if there is one.
    pub topic: Option<String>,
    /// Names of the frames in a bag; `None` if the file names none.
    pub frames: Option<FrameNames>,
    /// Poses in strictly increasing order of time.
    pub poses: Vec<EstimatedPose>,
    /// Covariance of each pose; empty if the file states none.
    pub covariances: Vec<PoseCovariance>,
    /// Position on the Earth from which the positions count east, north and up, if they were latitudes and longitudes.
    pub origin: Option<Geodetic>,
    pub findings: Vec<Finding>,
}

/// Names of the frames of a pose: that of the child in the parent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameNames {
    pub parent: String,
    /// `None` for a message without, such as `PoseStamped`.
    pub child: Option<String>,
}

impl EstimatedTrajectory {
    /// Returns true if every pose has an orientation.
    pub fn has_orientations(&self) -> bool {
        self.poses.iter().all(|pose| pose.orientation.is_some())
    }

    /// Returns true if both were read from the same file and topic.
    pub fn is_same(&self, other: &Self) -> bool {
        self.path == other.path && self.topic == other.topic
    }
}

/// Unique names of estimates, with as many folder names as needed: systems often name their files alike.
pub fn names_of_trajectories<'a>(
    estimates: impl Iterator<Item = &'a EstimatedTrajectory>,
) -> Vec<String> {
    let named: Vec<(&str, PathBuf)> =
        estimates.map(|one| (&*one.name, one.path.with_extension(""))).collect();
    let named = named.iter().map(|(name, path)| ((*name).to_owned(), Some(&**path)));
    told_apart(&named.collect::<Vec<_>>())
}

/// Pose of the estimate's body in the estimate's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatedPose {
    pub time_s: f64,
    pub position_m: Vector3<f64>,
    /// `None` if the file has positions only.
    pub orientation: Option<UnitQuaternion<f64>>,
}

/// Covariance of a pose, in the frame of the trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseCovariance {
    /// Covariance of the position (m²).
    pub position_m2: Matrix3<f64>,
    /// Covariance of the rotation vector θ (rad²): the true orientation is exp(θ) times this one. `None` if it is not known.
    pub rotation_rad2: Option<Matrix3<f64>>,
    /// Covariance between rotation (rows) and position (rad m).
    pub rotation_with_position: Matrix3<f64>,
}

impl PoseCovariance {
    /// Returns independent errors of a position with these standard deviations (m).
    pub fn of_position(sigma_m: &Vector3<f64>) -> Self {
        Self {
            position_m2: Matrix3::from_diagonal(&sigma_m.component_mul(sigma_m)),
            rotation_rad2: None,
            rotation_with_position: Matrix3::zeros(),
        }
    }
}
