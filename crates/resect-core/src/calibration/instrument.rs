//! What is known of total stations before a drive says anything about them.

use crate::geometry::ARCSECOND_RAD;
use serde::{Deserialize, Serialize};

/// Compensators hold a station upright to about this (rad, 1 σ): an arcsecond.
pub const TILT_SIGMA_RAD: f64 = ARCSECOND_RAD;
/// How well prism constants are known (m, 1 σ).
pub const PRISM_CONSTANT_SIGMA_M: f64 = 0.0003;

/// How large the errors of instruments are before a drive says anything about them (1 σ).
///
/// Sources: manuals of total stations and prisms, and the papers that the README names.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ErrorSizes {
    /// The clocks of stations 2 and 3 against station 1's (s): not known.
    pub clock_offset_s: f64,
    pub clock_drift: f64,
    /// How much a clock wanders during a drive beside that (s).
    pub clock_wander_s: f64,
    /// Time between the angles and the range of a reading (s).
    pub latency_s: f64,
    /// Error of the inter-prism distances (m); [`super::CalibrationSettings::inter_prism_sigma_m`] takes its place.
    #[serde(skip)]
    pub inter_prism_m: f64,
    /// What a compensator leaves (rad).
    pub lean_rad: f64,
    /// Constant error of a station's ranges to its prism (m): the prism's constant, its centring, the instrument's
    /// zero.
    pub range_offset_m: f64,
    /// Error of a station's ranges as a share of them: air and oscillator.
    pub range_scale: f64,
    /// Index error of the vertical circle (rad).
    pub index_rad: f64,
    /// Collimation error of the sight, or of the tracker on its prism (rad).
    pub collimation_rad: f64,
    /// How far a tripod turns (rad) and moves (m) during a drive.
    pub settling_rad: f64,
    pub settling_m: f64,
    /// Whether ranges may wander for seconds to minutes, as prisms make them that are seen from changing sides.
    pub ranges_wander: bool,
}

impl Default for ErrorSizes {
    fn default() -> Self {
        Self {
            clock_offset_s: 1.0,
            clock_drift: 5e-6,
            clock_wander_s: 2e-4,
            latency_s: 0.01,
            inter_prism_m: 0.001,
            lean_rad: 2.0 * ARCSECOND_RAD,
            range_offset_m: 0.0012,
            range_scale: 7e-6,
            index_rad: 4.0 * ARCSECOND_RAD,
            collimation_rad: 3.0 * ARCSECOND_RAD,
            settling_rad: 36e-6,
            settling_m: 0.0007,
            ranges_wander: true,
        }
    }
}
