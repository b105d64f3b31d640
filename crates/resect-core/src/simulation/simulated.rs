//! A simulated deployment and its truth.

use nalgebra::Vector3;

use super::motion::Motion;
use super::scenario::Scenario;
use crate::deployment::{ControlPointSet, GnssFix, RawRecord};
use crate::geometry::{LevelTransform, Polar, RigidTransform};

/// Unix time of the first reading (s); any will do.
pub const EPOCH_S: f64 = 1_760_000_000.0;

/// Everything that was measured, and the truth behind it.
#[derive(Clone, Debug)]
pub struct Simulated {
    /// The scenario, with the errors that were drawn.
    pub scenario: Scenario,
    pub seed: u64,
    /// Readings of all stations in order of time; ranges lack the prism constant.
    pub records: Vec<RawRecord>,
    pub control_points: Vec<ControlPointSet>,
    /// A static station's averaged reading of the three prisms, prism constant included.
    pub rig_reading: [Polar; 3],
    pub antennas: Option<[Vec<GnssFix>; 3]>,
    pub truth: Truth,
}

/// What no calibration may look at.
#[derive(Clone, Debug)]
pub struct Truth {
    /// How the stations were set up, level by station 1's plumb line: what is wrong besides is in the errors.
    pub station1_from_station: [LevelTransform; 3],
    pub inter_prism_m: [f64; 3],
    /// Prisms about the vehicle's origin: x ahead, y left, z up (m).
    pub prisms_m: [Vector3<f64>; 3],
    /// The drive itself, from [`EPOCH_S`] on.
    pub motion: Motion,
    /// Readings that were given a gross error, and how many were suppressed as lost locks.
    pub outliers: usize,
    pub lost_readings: usize,
}

impl Simulated {
    /// Where the frame of each station is at a time of the drive (s, 0 at [`EPOCH_S`]), settling included.
    ///
    /// It maps the station's frame of that moment into station 1's frame at set-up, which is the frame of all
    /// truth here. Station 1's own is the identity only until it settles. A frame is what the tripod carries, so the
    /// leaning of [`super::Settling`] is in it; tilt and plumb line are errors of the axes against it, and are not.
    pub fn station1_from_station_at(&self, time_s: f64) -> [RigidTransform; 3] {
        let errors = &self.scenario.errors;
        std::array::from_fn(|station| {
            errors.settled(station, &self.truth.station1_from_station[station], time_s)
        })
    }
}
