//! Comparison of two solutions.

use crate::geometry::{LevelTransform, wrap_to_pi};
use crate::network::PerStation;

/// Two solutions with a smaller distance are the same minimum (m). Source: the paper uses this limit for its prior (Vaidis et al.
/// 2022).
pub const SAME_TRANSLATION_M: f64 = 0.05;
/// Two solutions with a smaller difference of yaw are the same minimum (rad). Source: the paper uses this limit for its prior
/// (Vaidis et al. 2022).
pub const SAME_YAW_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// Returns true if two solutions are the same minimum.
pub fn same_solution(a: &PerStation<LevelTransform>, b: &PerStation<LevelTransform>) -> bool {
    a.iter().zip(b).all(|(a, b)| same_pose(a, b))
}

/// Returns true if two poses of a station are those of the same minimum.
pub fn same_pose(a: &LevelTransform, b: &LevelTransform) -> bool {
    (a.translation_m - b.translation_m).norm() < SAME_TRANSLATION_M
        && wrap_to_pi(a.yaw_rad - b.yaw_rad).abs() < SAME_YAW_RAD
}
