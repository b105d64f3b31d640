//! A drive in progress as plain data: what was read, and what is known of stations, rig and instruments.

use nalgebra::Vector3;

use crate::calibration::ErrorSizes;
use crate::calibration::joint::Expected;
use crate::geometry::LevelTransform;
use crate::pipeline::{Thresholds, Triplets};

/// A drive in progress.
#[derive(Clone, Copy, Debug)]
pub struct SoFar<'a> {
    /// What the pipeline makes of the readings so far.
    pub triplets: &'a Triplets,
    /// Where the stations are, as far as it is known: any answer does.
    pub station1_from_station: &'a [LevelTransform; 3],
    /// Prisms in any frame of the vehicle; all the same where all stations follow one.
    pub prisms_m: &'a [Vector3<f64>; 3],
    /// How large errors are, with that of the rig's distances ([`ErrorSizes::inter_prism_m`]).
    pub sizes: &'a ErrorSizes,
    /// How noisy readings are: as an estimate learned it, or as is usual.
    pub expected: Expected,
    /// Readings per second of each station.
    pub rate_hz: f64,
    pub thresholds: Thresholds,
    /// Further places at which the vehicle is to be known, in the frame of station 1: where it will work.
    pub places_m: &'a [Vector3<f64>],
    /// Largest root mean square error at the far end that is wanted.
    pub target_m: f64,
    pub speed_m_per_s: f64,
    pub turn_radius_m: f64,
}
