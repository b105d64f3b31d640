//! Slope, jumps and median of differences of clocks, which a few wrong values do not bend.

use super::SIGMA_OF_MAD;

/// Readings on either side that a jump is judged by.
const BESIDE_JUMP: usize = 5;
/// A jump is at least this (s) …
const SMALLEST_JUMP_S: f64 = 1e-3;
/// … and this many times what neighbouring differences scatter by.
const JUMP_OVER_NOISE: f64 = 8.0;
/// Points that a line is fitted to, at most.
const FITTED_POINTS: usize = 200;

/// Of the differences of neighbours: a jump changes one of them only.
pub fn slope_of_neighbours(times_s: &[f64], apart_s: &[f64]) -> f64 {
    let slopes =
        times_s.windows(2).zip(apart_s.windows(2)).map(|(t, d)| (d[1] - d[0]) / (t[1] - t[0]));
    median(slopes.collect())
}

/// Indices of the first readings after a jump, and its sizes.
pub fn jumps(times_s: &[f64], apart_s: &[f64], slope: f64) -> Vec<(usize, f64)> {
    let flat: Vec<f64> =
        times_s.iter().zip(apart_s).map(|(t, d)| d - slope * (t - times_s[0])).collect();
    let steps = flat.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let noise_s = SIGMA_OF_MAD * median(steps);
    let least_s = SMALLEST_JUMP_S.max(JUMP_OVER_NOISE * noise_s);
    let size = |index: usize| {
        let after = index..(index + BESIDE_JUMP).min(flat.len());
        let before = index.saturating_sub(BESIDE_JUMP)..index;
        median(flat[after].to_vec()) - median(flat[before].to_vec())
    };
    let mut found: Vec<(usize, f64)> = Vec::new();
    for index in BESIDE_JUMP..(flat.len() + 1).saturating_sub(BESIDE_JUMP) {
        let by_s = size(index);
        if by_s.abs() < least_s {
            continue;
        }
        // Its neighbours see the same jump; where it is, the step itself is largest.
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

/// The median slope over all pairs of a sample of the points (Theil 1950, Sen 1968).
pub fn theil_sen(times_s: &[f64], values: &[f64]) -> f64 {
    let every = times_s.len().div_ceil(FITTED_POINTS).max(1);
    let points: Vec<_> = times_s.iter().zip(values).step_by(every).collect();
    let slopes: Vec<f64> = points
        .iter()
        .enumerate()
        .flat_map(|(k, (t, v))| {
            points[k + 1..].iter().map(move |(later, value)| (*value - *v) / (*later - *t))
        })
        .filter(|slope| slope.is_finite())
        .collect();
    median(slopes)
}

/// 0 of nothing.
pub fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
