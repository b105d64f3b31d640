//! Variance components: noise of readings and process noise of the motion, estimated from the residuals.

use super::equations::{ANGLES, JERKS, RANGES, ResidualSquares, STAMPS};
use super::loss::CONSISTENCY;
use super::residuals::{ANGLE_RAD, NoiseLevels, OBSERVED_DISTANCE_SIGMA_M};

/// Levels of the first linearisation: a vehicle on wheels, and angles twice as noisy as stated.
pub const FIRST_LEVELS: NoiseLevels = NoiseLevels {
    range: 1.0,
    angle_rad: 2.0 * ANGLE_RAD,
    jitter_s: 0.002,
    distance_m: OBSERVED_DISTANCE_SIGMA_M,
    jerk_m_per_s3: 0.1,
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
    let jerks = squares.expected[JERKS].max(1.0);
    let redundancy = (1.0 - squares.absorbed[JERKS] / jerks).max(LEAST_JERK_REDUNDANCY);
    let jerk_factor = (squares.observed[JERKS] + squares.absorbed[JERKS]) / jerks;
    let jerk_factor = jerk_factor.powf(0.5 / redundancy);
    let limited = |factor: f64| factor.clamp(1.0 / LARGEST_FACTOR, LARGEST_FACTOR);
    let least_rad = LEAST_NOISE_FACTOR * ANGLE_RAD;
    let jitter_s = levels.jitter_s * limited(factor(STAMPS));
    let levels = NoiseLevels {
        distance_m: levels.distance_m,
        range: (levels.range * limited(factor(RANGES))).max(LEAST_NOISE_FACTOR),
        angle_rad: (levels.angle_rad * limited(factor(ANGLES))).max(least_rad),
        jitter_s: jitter_s.clamp(LEAST_JITTER_S, MOST_JITTER_S),
        jerk_m_per_s3: (levels.jerk_m_per_s3 * limited(jerk_factor)).max(LEAST_JERK_M_PER_S3),
    };
    // (16)
    let expected = squares.expected[RANGES] + squares.expected[ANGLES];
    (levels, ((remaining(RANGES) + remaining(ANGLES)) / expected.max(1e-9)).min(1.0))
}
