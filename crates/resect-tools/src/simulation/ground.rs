//! The ground of a drive, simulated or planned.

use serde::{Deserialize, Serialize};

/// Ground of the drive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Ground {
    /// Mean height (m) in the frame of the stations; negative if below station 1's instrument, in its own frame.
    pub height_m: f64,
    /// Root-mean-square slope of the bumps, which pitch and roll the vehicle (rad).
    pub slope_rms_rad: f64,
    /// Shortest and longest wavelength of the bumps (m).
    pub wavelengths_m: [f64; 2],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ramps: Vec<Ramp>,
}

/// A rise in the shape of a squared cosine about its centre.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ramp {
    pub centre_m: [f64; 2],
    pub radius_m: f64,
    pub height_m: f64,
}

impl Default for Ground {
    fn default() -> Self {
        Self { height_m: -1.6, slope_rms_rad: 0.05, wavelengths_m: [7.0, 30.0], ramps: Vec::new() }
    }
}
