//! Variance components: noise of readings and process noise of the motion, estimated from the residuals.

use super::equations::{
    HORIZONTAL_ANGLES, HORIZONTAL_JERKS, RANGES, ResidualSquares, STAMPS, VERTICAL_ANGLES,
    VERTICAL_JERKS,
};
use super::loss::CONSISTENCY;
use super::residuals::{ANGLE_RAD, NoiseLevels, OBSERVED_DISTANCE_SIGMA_M};

/// Levels of the first linearisation: a vehicle on wheels, and angles twice as noisy as stated.
pub const FIRST_LEVELS: NoiseLevels = NoiseLevels {
    range: 1.0,
    horizontal_rad: 2.0 * ANGLE_RAD,
    vertical_rad: 2.0 * ANGLE_RAD,
    jitter_s: 0.002,
    distance_m: OBSERVED_DISTANCE_SIGMA_M,
    horizontal_jerk_m_per_s3: 0.1,
    vertical_jerk_m_per_s3: 0.1,
};
/// Least process noise of the motion (m/s³): no vehicle is smoother.
const LEAST_JERK_M_PER_S3: f64 = 0.01;
/// Least noise of ranges and angles over the stated one: no instrument is twice as good as stated while its prism moves.
const LEAST_NOISE_FACTOR: f64 = 0.5;
/// Largest factor by which one step changes a level.
const LARGEST_FACTOR: f64 = 2.7;
/// Least redundancy of jerks by which the step is extrapolated.
const LEAST_JERK_REDUNDANCY: f64 = 0.25;
/// Least noise of the stamps.
const LEAST_JITTER_S: f64 = 1e-5;
/// Largest noise of the stamps. Field: stamps by a computer at the end of a serial line are randomly late by up to 15 ms.
const MOST_JITTER_S: f64 = 0.015;

/// Returns the noise levels by Helmert's estimate of variance components, and the mean redundancy number of a reading.
///
/// Each level is scaled by the root of observed over expected squares, where the motion absorbs a part of what is expected.
pub fn estimate_noise_levels(
    levels: &NoiseLevels,
    squares: &ResidualSquares,
) -> (NoiseLevels, f64) {
    let remaining = |kind: usize| {
        let expected = squares.expected[kind];
        (expected - squares.absorbed[kind]).max(0.02 * expected)
    };
    // (15)
    let factor = |kind: usize| match squares.expected[kind] {
        expected if expected > 0.0 => {
            (squares.observed[kind] / (CONSISTENCY * remaining(kind))).sqrt()
        }
        _ => 1.0,
    };
    // (17). A step of expectation maximisation, which converges slowly where the motion absorbs most, is extrapolated by the redundancy.
    let jerk_factor = |kind: usize| {
        let jerks = squares.expected[kind].max(1.0);
        let redundancy = (1.0 - squares.absorbed[kind] / jerks).max(LEAST_JERK_REDUNDANCY);
        ((squares.observed[kind] + squares.absorbed[kind]) / jerks).powf(0.5 / redundancy)
    };
    let limited = |factor: f64| factor.clamp(1.0 / LARGEST_FACTOR, LARGEST_FACTOR);
    let jerk = |level: f64, kind| (level * limited(jerk_factor(kind))).max(LEAST_JERK_M_PER_S3);
    let least_rad = LEAST_NOISE_FACTOR * ANGLE_RAD;
    let angle_rad = |level: f64, kind| (level * limited(factor(kind))).max(least_rad);
    let jitter_s = levels.jitter_s * limited(factor(STAMPS));
    let levels = NoiseLevels {
        distance_m: levels.distance_m,
        range: (levels.range * limited(factor(RANGES))).max(LEAST_NOISE_FACTOR),
        horizontal_rad: angle_rad(levels.horizontal_rad, HORIZONTAL_ANGLES),
        vertical_rad: angle_rad(levels.vertical_rad, VERTICAL_ANGLES),
        jitter_s: jitter_s.clamp(LEAST_JITTER_S, MOST_JITTER_S),
        horizontal_jerk_m_per_s3: jerk(levels.horizontal_jerk_m_per_s3, HORIZONTAL_JERKS),
        vertical_jerk_m_per_s3: jerk(levels.vertical_jerk_m_per_s3, VERTICAL_JERKS),
    };
    // (16)
    let kinds = [RANGES, HORIZONTAL_ANGLES, VERTICAL_ANGLES];
    let expected: f64 = kinds.map(|kind| squares.expected[kind]).iter().sum();
    let remaining: f64 = kinds.map(remaining).iter().sum();
    (levels, (remaining / expected.max(1e-9)).min(1.0))
}
