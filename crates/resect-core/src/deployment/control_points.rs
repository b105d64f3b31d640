//! Static points that the stations measured by hand.

use nalgebra::Vector3;

use crate::geometry::{Polar, RigidTransform};
use crate::network::{PerStation, Station, USUAL_STATIONS};

/// A static target with the reading of each station (prism constant included).
#[derive(Clone, Debug, PartialEq)]
pub struct ControlPoint {
    /// Marker number, valid inside its own file only.
    pub marker: i64,
    /// Readings, the mean of both faces if there are both.
    pub readings: PerStation<Option<Polar>>,
    /// Readings in face I alone, if there are both faces.
    pub face_one: PerStation<Option<Polar>>,
    /// Surveyed coordinates in a frame common to its set (m, z up); `None` if no file has them.
    pub known_m: Option<Vector3<f64>>,
}

impl ControlPoint {
    /// Returns a point without readings.
    pub fn unread(marker: i64, known_m: Option<Vector3<f64>>) -> Self {
        let (readings, face_one) =
            (PerStation::repeat(USUAL_STATIONS, None), PerStation::repeat(USUAL_STATIONS, None));
        Self { marker, readings, face_one, known_m }
    }

    /// Sets the reading of a station, and that in face I alone if there are both faces.
    pub fn set_reading(
        &mut self,
        station: Station,
        reading: Option<Polar>,
        face_one: Option<Polar>,
    ) {
        self.resize(self.readings.len().max(station.number()));
        (self.readings[station], self.face_one[station]) = (reading, face_one);
    }

    /// Changes the number of stations; further ones have no reading.
    pub fn resize(&mut self, stations: usize) {
        self.readings.resize_with(stations, || None);
        self.face_one.resize_with(stations, || None);
    }

    /// Keeps the readings of some stations, in this order.
    pub fn choose(&mut self, stations: &PerStation<Station>) {
        let chosen = |all: &PerStation<Option<Polar>>| {
            stations.map(|station| all.get(*station).copied().flatten())
        };
        (self.readings, self.face_one) = (chosen(&self.readings), chosen(&self.face_one));
    }

    /// Returns the number of stations up to the last one with a reading.
    pub fn stations(&self) -> usize {
        self.readings.iter().rposition(Option::is_some).map_or(0, |last| last + 1)
    }

    /// Returns true if its coordinates are known and every station measured it.
    pub fn serves_resection(&self) -> bool {
        self.known_m.is_some() && self.readings.iter().all(Option::is_some)
    }

    /// Distances (m) between the readings of each two stations in station 1's frame, without those of stations that did not
    /// measure the point.
    pub fn disagreements_m(
        &self,
        station1_from_station: &PerStation<RigidTransform>,
    ) -> impl Iterator<Item = f64> {
        let placed = self.readings.zip(station1_from_station, |polar, transform| {
            polar.map(|polar| transform.apply(&polar.to_cartesian()))
        });
        let placed: Vec<Vector3<f64>> = placed.into_iter().flatten().collect();
        let pairs = (0..placed.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
        pairs.map(move |(a, b)| (placed[a] - placed[b]).norm())
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
    /// Their median is the paper's control-point metric.
    /// `station1_from_station[0]` is the identity.
    pub fn disagreements_m(&self, station1_from_station: &PerStation<RigidTransform>) -> Vec<f64> {
        self.points.iter().flat_map(|point| point.disagreements_m(station1_from_station)).collect()
    }
}
