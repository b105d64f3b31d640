//! Deployments with known truth, made from a preset and a seed; the same seed gives the same bytes.
//!
//! [`scenario`] says what is driven where, [`motion`] moves the vehicle over the ground, [`instrument`] measures
//! it as three stations would, [`gnss`] as three antennas would, and [`write`] puts the readings into the formats of real deployments.

mod errors;
mod gnss;
mod instrument;
mod motion;
mod scenario;
mod write;

pub use errors::SystematicErrors;
pub use instrument::EPOCH_S;
pub use motion::Motion;
pub use scenario::{ARCSECOND_RAD, Path, Preset, Scenario};
pub use write::write_folder;

use nalgebra::Vector3;

use crate::deployment::{ControlPointSet, Deployment, GnssFix, OpenError, RawRecord, open_files};
use crate::geometry::{LevelTransform, Polar};

/// Everything that was measured, and the truth behind it.
#[derive(Clone, Debug)]
pub struct Simulated {
    pub scenario: Scenario,
    pub seed: u64,
    /// In order of time; ranges lack the prism constant.
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

/// Simulates a preset.
pub fn simulate(preset: Preset, seed: u64) -> Simulated {
    simulate_scenario(&preset.scenario(), seed)
}

/// Simulates any scenario.
pub fn simulate_scenario(scenario: &Scenario, seed: u64) -> Simulated {
    instrument::measure(scenario, seed)
}

impl Simulated {
    /// The deployment that a reader makes of the written files, without the disk.
    pub fn deployment(&self) -> Result<Deployment, OpenError> {
        let files = write::files(self);
        let files: Vec<_> =
            files.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
        open_files(self.scenario.name, &files)
    }
}
