//! A trajectory of another system.

use std::path::PathBuf;

use nalgebra::{UnitQuaternion, Vector3};

use crate::deployment::Finding;
use crate::deployment::names::told_apart;

/// A trajectory as another system estimated it.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The file's name without its ending, and what else tells it from others.
    pub name: String,
    pub path: PathBuf,
    /// Which of those in a bag it is; `None` where there is one.
    pub topic: Option<String>,
    /// The poses in order of time, no two at one time.
    pub poses: Vec<EstimatedPose>,
    pub findings: Vec<Finding>,
}

impl Estimate {
    /// Whether the other was read from the same place.
    pub fn is_same(&self, other: &Self) -> bool {
        self.path == other.path && self.topic == other.topic
    }
}

/// The names of estimates, with as much of their folders as tells them apart: systems often call their files the same.
pub fn names<'a>(estimates: impl Iterator<Item = &'a Estimate>) -> Vec<String> {
    let named: Vec<(&str, PathBuf)> =
        estimates.map(|one| (&*one.name, one.path.with_extension(""))).collect();
    let named = named.iter().map(|(name, path)| ((*name).to_owned(), Some(&**path)));
    told_apart(&named.collect::<Vec<_>>())
}

/// Where the estimate's body is in the estimate's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatedPose {
    pub time_s: f64,
    pub position_m: Vector3<f64>,
    /// `None` where the file has positions only.
    pub orientation: Option<UnitQuaternion<f64>>,
}
