//! How noisy readings are and how jerky a drive is, out of their errors.

use super::equations::{OF_ANGLES, OF_JERKS, OF_RANGES, OF_STAMPS, Squares};
use super::loss::CONSISTENCY;
use super::observed::{ANGLE_RAD, Levels};

/// Where learning begins: a vehicle on wheels, and instruments that read half as well as they say.
pub const FIRST_LEVELS: Levels =
    Levels { range: 1.0, angle_rad: 2.0 * ANGLE_RAD, jitter_s: 0.002, jerk_m_per_s3: 0.1 };
/// No vehicle is smoother than this (m/s³), and no instrument twice as good as it says while its prism moves.
const LEAST_JERK_M_PER_S3: f64 = 0.01;
const LEAST_NOISE_FACTOR: f64 = 0.5;
/// What a step of learning multiplies a level by, at most, or divides it by.
const LONGEST_STRIDE: f64 = 2.7;
/// Motion that takes up more of its jerks than this is learned slower than its redundancy says.
const LEAST_REDUNDANCY: f64 = 0.25;
const LEAST_JITTER_S: f64 = 1e-5;
/// Stamps that a computer gives to what comes over a serial line are late by up to 15 ms, by chance.
const MOST_JITTER_S: f64 = 0.015;

/// Noise levels out of the errors and their redundancies, and the mean redundancy of readings.
pub fn learned(levels: &Levels, squares: &Squares) -> (Levels, f64) {
    let left = |kind: usize| {
        let expected = squares.expected[kind];
        (expected - squares.taken_up[kind]).max(0.02 * expected)
    };
    let factor = |kind: usize| match squares.expected[kind] {
        expected if expected > 0.0 => (squares.found[kind] / (CONSISTENCY * left(kind))).sqrt(),
        _ => 1.0,
    };
    // Expectation maximisation, which is slow where the motion is loosely held, stretched as far as is safe.
    let jerks = squares.expected[OF_JERKS].max(1.0);
    let redundancy = (1.0 - squares.taken_up[OF_JERKS] / jerks).max(LEAST_REDUNDANCY);
    let jerk_factor = (squares.found[OF_JERKS] + squares.taken_up[OF_JERKS]) / jerks;
    let jerk_factor = jerk_factor.powf(0.5 / redundancy);
    let stride = |factor: f64| factor.clamp(1.0 / LONGEST_STRIDE, LONGEST_STRIDE);
    let least_rad = LEAST_NOISE_FACTOR * ANGLE_RAD;
    let jitter_s = levels.jitter_s * stride(factor(OF_STAMPS));
    let levels = Levels {
        range: (levels.range * stride(factor(OF_RANGES))).max(LEAST_NOISE_FACTOR),
        angle_rad: (levels.angle_rad * stride(factor(OF_ANGLES))).max(least_rad),
        jitter_s: jitter_s.clamp(LEAST_JITTER_S, MOST_JITTER_S),
        jerk_m_per_s3: (levels.jerk_m_per_s3 * stride(jerk_factor)).max(LEAST_JERK_M_PER_S3),
    };
    let expected = squares.expected[OF_RANGES] + squares.expected[OF_ANGLES];
    (levels, ((left(OF_RANGES) + left(OF_ANGLES)) / expected.max(1e-9)).min(1.0))
}
