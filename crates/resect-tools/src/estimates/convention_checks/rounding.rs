//! The step to which the coordinates of a trajectory are rounded.

use resect_core::deployment::EstimatedPose;

/// Largest number of poses that are looked at.
const MOST_POSES: usize = 200;
/// Most decimal places that are looked at; more are exact for this purpose.
const MOST_PLACES: i32 = 9;
/// Largest difference from a whole number of steps, relative to the step: floating-point numbers of map coordinates.
const WHOLE: f64 = 2e-3;

/// Returns the step (m) to which the positions are rounded: a power of ten.
pub fn rounding_step_m(poses: &[EstimatedPose]) -> f64 {
    let step = poses.len().div_ceil(MOST_POSES).max(1);
    let coordinates: Vec<f64> = poses
        .iter()
        .step_by(step)
        .flat_map(|pose| pose.position_m.iter().copied().collect::<Vec<_>>())
        .collect();
    let are_whole = |places: &i32| {
        let steps = 10_f64.powi(*places);
        coordinates.iter().all(|value| (value * steps - (value * steps).round()).abs() < WHOLE)
    };
    10_f64.powi(-(0..MOST_PLACES).find(are_whole).unwrap_or(MOST_PLACES))
}
