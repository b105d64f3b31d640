//! A drive in progress as plain data: readings, and current estimates of stations, rig and instruments.

use nalgebra::Vector3;

use resect_core::calibration::ErrorSizes;
use resect_core::calibration::joint::ExpectedNoise;
use resect_core::geometry::LevelTransform;
use resect_core::network::{PerPrism, PerStation, Prism};
use resect_core::pipeline::{Thresholds, Triplets};

/// A drive in progress.
#[derive(Clone, Copy, Debug)]
pub struct SoFar<'a> {
    /// Triplets of the readings so far.
    pub triplets: &'a Triplets,
    /// Approximate poses of the stations, from any calibration.
    pub station1_from_station: &'a PerStation<LevelTransform>,
    /// The prism that each station follows.
    pub followed: &'a PerStation<Prism>,
    /// Prisms in any frame of the vehicle (m).
    pub prisms_m: &'a PerPrism<Vector3<f64>>,
    /// Standard deviations of the priors, that of the rig's distances included ([`ErrorSizes::inter_prism_m`]).
    pub sizes: &'a ErrorSizes,
    /// Noise levels of the readings, estimated or typical.
    pub expected: ExpectedNoise,
    /// Readings per second of each station.
    pub rate_hz: f64,
    pub thresholds: Thresholds,
    /// Further places of interest, in which the vehicle will work (m, station 1's frame).
    pub places_m: &'a [Vector3<f64>],
    /// Target for the root mean square error at the far end (m).
    pub target_m: f64,
    pub speed_m_per_s: f64,
    pub turn_radius_m: f64,
}
