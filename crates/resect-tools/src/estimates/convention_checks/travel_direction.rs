//! Direction of travel in the body: most bodies move forward, whatever their world.

use nalgebra::{UnitQuaternion, Vector3};

use resect_core::deployment::EstimatedPose;
use resect_core::statistics::median;

/// Time over which a direction is computed (s), and the longest and shortest way in it (m).
const SPAN_S: f64 = 1.0;
const LONGEST_SPAN_S: f64 = 2.0;
const SHORTEST_M: f64 = 0.25;
/// Largest number of directions, and the fewest.
const MOST: usize = 400;
const FEWEST: usize = 40;

/// A direction of travel, and the orientation in its middle.
#[derive(Clone, Copy, Debug)]
pub struct Travel {
    pub direction: Vector3<f64>,
    pub orientation: UnitQuaternion<f64>,
}

/// Returns the directions of travel, evenly spread over the poses.
pub fn travels(poses: &[EstimatedPose]) -> Vec<Travel> {
    let travel = |start: usize| {
        let from = poses[start];
        let end = start + poses[start..].partition_point(|pose| pose.time_s < from.time_s + SPAN_S);
        let to = poses.get(end).filter(|to| to.time_s < from.time_s + LONGEST_SPAN_S)?;
        let orientation = poses[start + (end - start) / 2].orientation?;
        let way_m = to.position_m - from.position_m;
        (way_m.norm() > SHORTEST_M).then(|| Travel { direction: way_m.normalize(), orientation })
    };
    (0..poses.len()).step_by(poses.len().div_ceil(MOST).max(1)).filter_map(travel).collect()
}

/// Median angle of the directions in the body from their mean (rad), with a function of the orientations; `None` if there are few.
pub fn scatter_in_body_rad(
    travels: &[Travel],
    orientation: impl Fn(UnitQuaternion<f64>) -> UnitQuaternion<f64>,
) -> Option<f64> {
    if travels.len() < FEWEST {
        return None;
    }
    let in_body: Vec<Vector3<f64>> = travels
        .iter()
        .map(|travel| orientation(travel.orientation).inverse() * travel.direction)
        .collect();
    let mean = in_body.iter().sum::<Vector3<f64>>().try_normalize(f64::EPSILON)?;
    median(in_body.iter().map(|direction| direction.dot(&mean).clamp(-1.0, 1.0).acos()))
}
