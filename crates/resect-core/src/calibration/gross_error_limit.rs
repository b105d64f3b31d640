//! The limit of gross errors of inter-prism distances.

use crate::statistics::median;

/// An instant is a gross outlier if one of its distances exceeds both limits: this error (m), and the multiple [`WILD_TIMES`].
/// Bends and stops cause chord errors of 20 mm. Outliers seem to rotate the rig, so unobservable directions seem observable.
/// A hundredth of the triplets with errors of 20 mm adds 5e-6 to the smallest eigenvalue.
const WILD_M: f64 = 0.02;
/// A gross outlier also exceeds this multiple of the median of the worst errors.
const WILD_TIMES: f64 = 5.0;

/// Least limit where readings follow each other within a fifth of a second (m).
/// Effect: distances of a rig may differ by so little, and a station on another prism has only this error where one other station sees the rig.
const LEAST_WILD_M: f64 = 0.01;
/// Chord error by the square of the time between readings (m/s²). Textbook: an eighth of the acceleration, here 1 m/s².
const CHORD_M_PER_S2: f64 = 0.125;

/// Returns the limit of the worst error of an instant's distances (m); `None` without errors.
pub fn gross_error_limit_m(worst_m: impl Iterator<Item = f64>) -> Option<f64> {
    limit_m(worst_m, WILD_M)
}

/// Returns this limit for readings that are as far apart in time (s).
pub fn gross_error_limit_of_step_m(worst_m: impl Iterator<Item = f64>, step_s: f64) -> Option<f64> {
    limit_m(worst_m, (CHORD_M_PER_S2 * step_s.powi(2)).clamp(LEAST_WILD_M, WILD_M))
}

fn limit_m(worst_m: impl Iterator<Item = f64>, least_m: f64) -> Option<f64> {
    Some(least_m.max(WILD_TIMES * median(worst_m)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_smaller_where_readings_follow_each_other_fast() {
        let limit_m = |error_m: f64, step_s: f64| {
            gross_error_limit_of_step_m(std::iter::repeat_n(error_m, 9), step_s).expect("errors")
        };
        assert_eq!([1.0, 0.4, 0.05].map(|step_s| limit_m(1e-3, step_s)), [0.02, 0.02, 0.01]);
        assert_eq!(limit_m(5e-3, 0.05), 0.025);
    }
}
