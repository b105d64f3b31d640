//! Pose, clock and scale of one body relative to another.

use nalgebra::{Matrix3, Vector3};

use resect_core::calibration::Estimate;
use resect_core::geometry::RigidTransform;

/// Standard deviations of a good calibration: of the lever arm (m), the rotation (rad) and the time offset (s).
/// Field: RTK and total stations are good to 10 to 20 mm; at 1 m/s, 5 ms are 5 mm.
pub const GOOD_LEVER_M: f64 = 0.02;
pub const GOOD_ROTATION_RAD: f64 = 5e-3;
pub const GOOD_TIME_S: f64 = 5e-3;

/// Pose, clock and scale of b relative to a, by one span of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Pose of b in a; the rotation is the identity if b has positions only.
    pub a_from_b: RigidTransform,
    /// Standard deviations of the lever arm, which is b's origin in a (m); `None` if it was given.
    pub lever_sigma_m: Option<Vector3<f64>>,
    pub lever_covariance_m2: Option<Matrix3<f64>>,
    /// False for an axis of a along which only the prior decides.
    pub determines_lever: [bool; 3],
    /// Standard deviations about a's axes (rad); `None` without orientations of b.
    pub rotation_sigma_rad: Option<Vector3<f64>>,
    /// Added to b's times (s).
    pub time_offset_s: f64,
    pub time_offset_sigma_s: Option<f64>,
    /// Ratio of a's lengths to b's.
    pub scale: Option<Estimate>,
}
