//! A simulated deployment and its ground truth.

use nalgebra::{Matrix6, Rotation3, Vector3};

use super::motion::Motion;
use super::scenario::Scenario;
use resect_core::deployment::{ControlPointSet, GnssFix, RawRecord};
use resect_core::evaluation::trajectory::{Pose, Trajectory};
use resect_core::geometry::{LevelTransform, Polar, RigidTransform};
use resect_core::network::{Number, PerPair, PerPrism, PerStation};

/// Unix time of the first reading (s), arbitrary.
pub const EPOCH_S: f64 = 1_760_000_000.0;

/// All simulated readings and their ground truth.
#[derive(Clone, Debug)]
pub struct Simulated {
    /// The scenario, with the errors that were drawn.
    pub scenario: Scenario,
    pub seed: u64,
    /// Readings of all stations in order of time; ranges lack the prism constant.
    pub records: Vec<RawRecord>,
    pub control_points: Vec<ControlPointSet>,
    /// A static station's averaged reading of the prisms, prism constant included.
    pub rig_reading: PerPrism<Polar>,
    pub antennas: Option<[Vec<GnssFix>; 3]>,
    pub truth: Truth,
}

/// Ground truth, not available to any calibration.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Poses of the stations at set-up for the drive, level by station 1's plumb line. Other deviations are among the errors.
    pub station1_from_station: PerStation<LevelTransform>,
    /// Level poses of the stations when they measured the control points, in station 1's frame of that time.
    pub station1_from_station_at_survey: PerStation<LevelTransform>,
    pub inter_prism_m: PerPair<f64>,
    /// Prisms in the vehicle's frame: x ahead, y left, z up (m).
    pub prisms_m: PerPrism<Vector3<f64>>,
    /// Motion of the vehicle from [`EPOCH_S`] on.
    pub motion: Motion,
    /// Number of readings with a gross error, and number of readings suppressed by lost locks.
    pub outliers: usize,
    pub lost_readings: usize,
}

impl Simulated {
    /// Returns the pose of each station's frame at a time of the drive (s, 0 at [`EPOCH_S`]), settling included.
    ///
    /// Each transform maps the station's frame of that time into station 1's frame at set-up, in which all ground truth is
    /// given. The transform of station 1 is the identity until it settles. A frame is fixed to the tripod, so it contains
    /// the tilt of [`super::Settling`]. Tilt and plumb line of the axes are errors relative to the frame and are not
    /// contained.
    pub fn station1_from_station_at(&self, time_s: f64) -> PerStation<RigidTransform> {
        let errors = &self.scenario.errors;
        let at_set_up = &self.truth.station1_from_station;
        at_set_up.map_each(|station, pose| errors.settled(station.index(), pose, time_s))
    }

    /// Returns the true poses of the vehicle in the frame of station 1 at set-up, this far apart (s).
    pub fn true_trajectory(&self, apart_s: f64) -> Trajectory {
        let pose = |step: usize| {
            let time_s = step as f64 * apart_s;
            let (position_m, axes) = self.truth.motion.pose(time_s);
            Pose {
                time_s: EPOCH_S + time_s,
                position_m,
                orientation: Rotation3::from_matrix_unchecked(axes).into(),
                covariance: Matrix6::zeros(),
                twist: None,
                inter_prism_error_m: 0.0,
            }
        };
        let steps = (self.scenario.duration_s / apart_s).floor() as usize;
        Trajectory { poses: (0..=steps).map(pose).collect(), ..Trajectory::default() }
    }
}
