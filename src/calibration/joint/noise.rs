//! How noisy readings are and how jerky a drive is, out of their errors.

use super::equations::{ANGLE_RAD, Levels, OF_ANGLES, OF_JERKS, OF_RANGES, OF_STAMPS, Squares};

/// What is learned begins here: what is stated, and a motion that is free to follow the readings.
pub const FIRST_LEVELS: Levels =
    Levels { range: 1.0, angle_rad: ANGLE_RAD, jitter_s: 0.001, jerk_m_per_s3: 1.0 };
/// No vehicle is smoother than this (m/s³), and no instrument ten times as good as it says.
const LEAST_JERK_M_PER_S3: f64 = 0.01;
const LEAST_NOISE_FACTOR: f64 = 0.1;
/// What Cauchy's weights leave of the mean square of three normal errors, over the mean weight.
const CONSISTENCY: f64 = 0.915;
const LEAST_JITTER_S: f64 = 1e-5;
const MOST_JITTER_S: f64 = 0.1;

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
    // The motion is hardly redundant where it is loosely held: expectation maximisation is slower and never astray.
    let jerks = squares.expected[OF_JERKS].max(1.0);
    let jerk_factor = ((squares.found[OF_JERKS] + squares.taken_up[OF_JERKS]) / jerks).sqrt();
    let least_rad = LEAST_NOISE_FACTOR * ANGLE_RAD;
    // A kind that loses noise to another one gets some of it back the next time: half of each step ends that sooner.
    let levels = Levels {
        range: (levels.range * factor(OF_RANGES).sqrt()).max(LEAST_NOISE_FACTOR),
        angle_rad: (levels.angle_rad * factor(OF_ANGLES).sqrt()).max(least_rad),
        jitter_s: (levels.jitter_s * factor(OF_STAMPS).sqrt()).clamp(LEAST_JITTER_S, MOST_JITTER_S),
        jerk_m_per_s3: (levels.jerk_m_per_s3 * jerk_factor).max(LEAST_JERK_M_PER_S3),
    };
    let expected = squares.expected[OF_RANGES] + squares.expected[OF_ANGLES];
    (levels, ((left(OF_RANGES) + left(OF_ANGLES)) / expected.max(1e-9)).min(1.0))
}
