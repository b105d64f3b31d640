//! The limit of gross errors of inter-prism distances.

use crate::statistics::median;

/// An instant is a gross outlier if one of its distances exceeds both limits: this error (m), and the multiple [`WILD_TIMES`].
/// Bends and stops cause chord errors of 20 mm. Outliers seem to rotate the rig, so unobservable directions seem observable.
/// A hundredth of the triplets with errors of 20 mm adds 5e-6 to the smallest eigenvalue.
const WILD_M: f64 = 0.02;
/// A gross outlier also exceeds this multiple of the median of the worst errors.
const WILD_TIMES: f64 = 5.0;

/// Returns the limit of the worst error of an instant's distances (m); `None` without errors.
pub fn gross_error_limit_m(worst_m: impl Iterator<Item = f64>) -> Option<f64> {
    Some(WILD_M.max(WILD_TIMES * median(worst_m)?))
}
