//! Priors of total stations: sizes of their errors before a drive.

use crate::geometry::ARCSECOND_RAD;
use serde::{Deserialize, Serialize};

/// Tilt error that a compensator leaves (rad, 1 σ): an arcsecond.
pub const TILT_SIGMA_RAD: f64 = ARCSECOND_RAD;
/// Error of a prism constant (m, 1 σ).
pub const PRISM_CONSTANT_SIGMA_M: f64 = 0.0003;

/// Standard deviations of the instrument errors before a drive (1 σ).
///
/// Sources: manuals of total stations and prisms, and the paper (Vaidis et al. 2022).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ErrorSizes {
    /// Offset of the clocks from station 1's (s). A larger offset that is significant widens this prior.
    pub clock_offset_s: f64,
    pub clock_drift: f64,
    /// Random walk of a clock during a drive, beside offset and drift (s).
    pub clock_wander_s: f64,
    /// Age of the angles when the range is measured (s).
    pub latency_s: f64,
    /// Error of the inter-prism distances (m), replaced by [`super::CalibrationSettings::inter_prism_sigma_m`].
    #[serde(skip)]
    pub inter_prism_m: f64,
    /// Tilt that a compensator leaves (rad).
    pub lean_rad: f64,
    /// Additive error of a station's ranges to its prism (m): prism constant, centring, zero of the instrument.
    pub range_offset_m: f64,
    /// Scale error of a station's ranges: air and oscillator.
    pub range_scale: f64,
    /// Vertical index error (rad).
    pub index_rad: f64,
    /// Collimation error of the sight, or of the tracker on its prism (rad).
    pub collimation_rad: f64,
    /// Coefficients of refraction beyond the usual one, upward and sideways: the curvature of a sight over that of the earth.
    pub refraction: f64,
    /// Rotation (rad) and displacement (m) of a tripod during a drive.
    pub settling_rad: f64,
    pub settling_m: f64,
    /// True if errors of ranges and sights may vary over seconds to minutes, as with prisms that are seen from changing sides.
    pub ranges_wander: bool,
}

impl Default for ErrorSizes {
    fn default() -> Self {
        Self {
            clock_offset_s: 0.02,
            // The authors' synchronised clocks drift by parts per million.
            clock_drift: 5e-6,
            clock_wander_s: 2e-4,
            latency_s: 0.01,
            inter_prism_m: 0.001,
            lean_rad: 2.0 * ARCSECOND_RAD,
            // A prism and its centring 0.7 mm, and as much of the instrument and the adapter each.
            range_offset_m: 0.0012,
            // By the EDM formula 1 ppm per kelvin and 0.3 ppm per hectopascal, for an error of five degrees and of the oscillator.
            range_scale: 7e-6,
            // 1″ to 10″ in the manuals of instruments, as for collimation and lean; the compensator corrects most of a lean.
            index_rad: 4.0 * ARCSECOND_RAD,
            collimation_rad: 3.0 * ARCSECOND_RAD,
            // A gradient of the temperature of 0.2 K/m gives 1.2; 15 in a tunnel or over hot ground (gradients of 2 K/m) is three times that.
            refraction: 5.0,
            // Tens of microradians in hours, and about a millimetre in total, by common surveying experience; more on soft ground.
            settling_rad: 36e-6,
            settling_m: 0.0007,
            ranges_wander: true,
        }
    }
}
