//! How far what belongs together is apart by an answer: the distances of a rig, and control points.

use nalgebra::Vector3;

use crate::deployment::{ControlPointSet, PAIRS};
use crate::geometry::RigidTransform;
use crate::pipeline::Triplets;
use crate::statistics::median;

/// Errors of the three distances of every triplet (m): apparent minus known, for pairs 12, 13, 23.
pub fn distance_errors_m(
    triplets: &Triplets,
    station1_from_station: &[RigidTransform; 3],
    inter_prism_m: &[f64; 3],
) -> [Vec<f64>; 3] {
    let mut errors: [Vec<f64>; 3] = std::array::from_fn(|_| Vec::with_capacity(triplets.len()));
    for index in 0..triplets.len() {
        let placed: [Vector3<f64>; 3] = std::array::from_fn(|station| {
            station1_from_station[station].apply(&triplets.points_m[station][index])
        });
        for (pair, (a, b)) in PAIRS.into_iter().enumerate() {
            errors[pair].push((placed[a] - placed[b]).norm() - inter_prism_m[pair]);
        }
    }
    errors
}

/// Median distance between what two stations make of a control point (m); `None` where no two stations share one.
pub fn control_points_apart_m(
    control_points: &[ControlPointSet],
    station1_from_station: &[RigidTransform; 3],
) -> Option<f64> {
    let sets = control_points.iter().filter(|set| !set.pillars);
    median(sets.flat_map(|set| set.disagreements_m(station1_from_station)))
}
