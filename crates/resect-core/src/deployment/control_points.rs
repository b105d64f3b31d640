//! Static points that the stations measured by hand.

use nalgebra::Vector3;

use super::pairs::PAIRS;
use crate::geometry::{Polar, RigidTransform};
use crate::network::PerStation;

/// A static target with the reading of each station (prism constant included).
#[derive(Clone, Debug, PartialEq)]
pub struct ControlPoint {
    /// Marker number, valid inside its own file only.
    pub marker: i64,
    /// Readings, the mean of both faces if there are both.
    pub readings: [Option<Polar>; 3],
    /// Readings in face I alone, if there are both faces.
    pub face_one: [Option<Polar>; 3],
    /// Surveyed coordinates in a frame common to its set (m, z up); `None` if no file has them.
    pub known_m: Option<Vector3<f64>>,
}

impl ControlPoint {
    /// Returns true if its coordinates are known and every station measured it.
    pub fn serves_resection(&self) -> bool {
        self.known_m.is_some() && self.readings.iter().all(Option::is_some)
    }

    /// Distances (m) between the stations' readings of the point in station 1's frame: three, or fewer if a station did not
    /// measure it.
    pub fn disagreements_m(
        &self,
        station1_from_station: &PerStation<RigidTransform>,
    ) -> impl Iterator<Item = f64> {
        let placed: [Option<Vector3<f64>>; 3] = std::array::from_fn(|station| {
            self.readings[station]
                .map(|polar| station1_from_station[station].apply(&polar.to_cartesian()))
        });
        PAIRS.into_iter().filter_map(move |(a, b)| Some((placed[a]? - placed[b]?).norm()))
    }
}

/// The control points of one file.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlPointSet {
    pub file: String,
    pub points: Vec<ControlPoint>,
    /// True for geodetic pillars with surveyed coordinates. They serve the two-point resection; the control-point metric
    /// excludes them, as in the paper.
    pub pillars: bool,
}

impl ControlPointSet {
    /// Distances (m) between the stations' readings of the same point in station 1's frame.
    ///
    /// Their median is the paper's control-point metric: up to three per point, fewer if a station did not measure it.
    /// `station1_from_station[0]` is the identity.
    pub fn disagreements_m(&self, station1_from_station: &PerStation<RigidTransform>) -> Vec<f64> {
        self.points.iter().flat_map(|point| point.disagreements_m(station1_from_station)).collect()
    }
}
