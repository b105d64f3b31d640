//! Agreement of estimates with each other against the ground truth, over the whole drive.

use nalgebra::Vector3;

use super::errors::EpochError;

/// Estimates agree if their difference is below this share of both errors.
const AGREE: f64 = 0.4;
/// Below this share of the errors, two estimates are copies of each other.
const COPIES: f64 = 0.01;
/// Longest time between errors that are interpolated (s).
const LONGEST_S: f64 = 1.0;
/// Smallest number of common times.
const FEWEST: usize = 10;

/// Two estimates that differ less from each other than each from the ground truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AgreeingPair {
    /// Indices of the estimates.
    pub estimates: [usize; 2],
    /// Root mean square difference between the two over their common times (m).
    pub apart_m: f64,
    /// Root mean square error of each at these times (m).
    pub rmse_m: [f64; 2],
}

/// Returns the pairs of estimates that agree with each other against the ground truth.
///
/// Errors of independent estimates do not agree. Either the ground truth is wrong, or the estimates share an error, such as the
/// scale of a wheel or the calibration of one sensor.
pub fn agreements(all: &[&[EpochError]]) -> Vec<AgreeingPair> {
    let mut agreements = Vec::new();
    for first in 0..all.len() {
        for second in first + 1..all.len() {
            agreements.extend(agreement([first, second], [all[first], all[second]]));
        }
    }
    agreements
}

fn agreement(estimates: [usize; 2], [first, second]: [&[EpochError]; 2]) -> Option<AgreeingPair> {
    let mut after = 0;
    let both: Vec<[Vector3<f64>; 2]> = first
        .iter()
        .filter_map(|error| {
            while second.get(after).is_some_and(|other| other.time_s < error.time_s) {
                after += 1;
            }
            Some([error.position_m, interpolated(second, after, error.time_s)?])
        })
        .collect();
    if both.len() < FEWEST {
        return None;
    }
    let rms = |of: &dyn Fn(&[Vector3<f64>; 2]) -> Vector3<f64>| {
        let sum: f64 = both.iter().map(|pair| of(pair).norm_squared()).sum();
        (sum / both.len() as f64).sqrt()
    };
    let apart_m = rms(&|[a, b]| a - b);
    let rmse_m = [rms(&|[a, _]| *a), rms(&|[_, b]| *b)];
    let smaller_m = rmse_m[0].min(rmse_m[1]);
    (COPIES * smaller_m..AGREE * smaller_m).contains(&apart_m).then_some(AgreeingPair {
        estimates,
        apart_m,
        rmse_m,
    })
}

/// Error at a time between those before and at the index.
fn interpolated(errors: &[EpochError], after: usize, time_s: f64) -> Option<Vector3<f64>> {
    let end = errors.get(after)?;
    if end.time_s == time_s {
        return Some(end.position_m);
    }
    let start = &errors[after.checked_sub(1)?];
    let length_s = end.time_s - start.time_s;
    let share = (time_s - start.time_s) / length_s;
    (length_s <= LONGEST_S).then(|| start.position_m.lerp(&end.position_m, share))
}
