//! The ground of a drive, simulated or planned.

use serde::{Deserialize, Serialize};

/// The ground that the vehicle drives on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Ground {
    /// Mean height (m) in the frame of the stations: below 0 under the instrument of station 1 in its own frame.
    pub height_m: f64,
    /// Root-mean-square slope of its bumps, which pitch and roll the vehicle.
    pub slope_rms_rad: f64,
    /// Shortest and longest wavelength of the bumps.
    pub wavelengths_m: [f64; 2],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ramps: Vec<Ramp>,
}

/// A rise that is driven up and down again: the square of a cosine about its centre.
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
