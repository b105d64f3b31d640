//! A trajectory of another system.

use std::path::PathBuf;

use nalgebra::{UnitQuaternion, Vector3};

use crate::deployment::Finding;
use crate::deployment::names::told_apart;

/// A trajectory estimated by another system.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimatedTrajectory {
    /// File name without its extension, with further words if needed to be unique.
    pub name: String,
    pub path: PathBuf,
    /// Topic in a bag of several trajectories; `None` if there is one.
    pub topic: Option<String>,
    /// Poses in strictly increasing order of time.
    pub poses: Vec<EstimatedPose>,
    pub findings: Vec<Finding>,
}

impl EstimatedTrajectory {
    /// Returns true if both were read from the same file and topic.
    pub fn is_same(&self, other: &Self) -> bool {
        self.path == other.path && self.topic == other.topic
    }
}

/// Unique names of estimates, with as many folder names as needed: systems often name their files alike.
pub fn names<'a>(estimates: impl Iterator<Item = &'a EstimatedTrajectory>) -> Vec<String> {
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
