//! Slope and jumps of clock differences, robust against outliers.

use std::ops::Range;

use crate::statistics::{median, sigma_of_errors};

/// Number of readings on either side from which a jump is estimated.
const BESIDE_JUMP: usize = 5;
/// Smallest jump (s).
const SMALLEST_JUMP_S: f64 = 1e-3;
/// Smallest jump in units of the scatter of neighbouring differences.
const JUMP_OVER_NOISE: f64 = 8.0;
/// Largest number of points to which a line is fitted.
const FITTED_POINTS: usize = 200;

/// Median slope between neighbours; a jump changes one of them only. 0 without distinct times.
pub fn slope_of_neighbours(times_s: &[f64], apart_s: &[f64]) -> f64 {
    let slopes =
        times_s.windows(2).zip(apart_s.windows(2)).map(|(t, d)| (d[1] - d[0]) / (t[1] - t[0]));
    median(slopes.filter(|slope| slope.is_finite())).unwrap_or(0.0)
}

/// Indices of the first readings after jumps, with the sizes of the jumps.
pub fn jumps(times_s: &[f64], apart_s: &[f64], slope: f64) -> Vec<(usize, f64)> {
    let flat: Vec<f64> =
        times_s.iter().zip(apart_s).map(|(t, d)| d - slope * (t - times_s[0])).collect();
    let noise_s = sigma_of_errors(flat.windows(2).map(|pair| pair[1] - pair[0])).unwrap_or(0.0);
    let least_s = SMALLEST_JUMP_S.max(JUMP_OVER_NOISE * noise_s);
    let size = |index: usize| {
        let after = index..(index + BESIDE_JUMP).min(flat.len());
        let before = index.saturating_sub(BESIDE_JUMP)..index;
        let level = |indices: Range<usize>| median(flat[indices].iter().copied()).unwrap_or(0.0);
        level(after) - level(before)
    };
    let mut found: Vec<(usize, f64)> = Vec::new();
    for index in BESIDE_JUMP..(flat.len() + 1).saturating_sub(BESIDE_JUMP) {
        let by_s = size(index);
        if by_s.abs() < least_s {
            continue;
        }
        // Neighbouring readings detect the same jump; the step is largest at the jump.
        let step = |index: usize| (flat[index] - flat[index - 1]).abs();
        match found.last_mut() {
            Some(last) if index - last.0 <= BESIDE_JUMP => {
                if step(index) > step(last.0) {
                    *last = (index, by_s);
                }
            }
            _ => found.push((index, by_s)),
        }
    }
    found
}

/// Median slope over all pairs of a sample of the points (Theil 1950, Sen 1968); 0 if there is none.
pub fn theil_sen(times_s: &[f64], values: &[f64]) -> f64 {
    let every = times_s.len().div_ceil(FITTED_POINTS).max(1);
    let points: Vec<_> = times_s.iter().zip(values).step_by(every).collect();
    let slopes = points.iter().enumerate().flat_map(|(k, (t, v))| {
        points[k + 1..].iter().map(move |(later, value)| (*value - *v) / (*later - *t))
    });
    median(slopes.filter(|slope| slope.is_finite())).unwrap_or(0.0)
}
