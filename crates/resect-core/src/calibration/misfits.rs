//! Misfits of an answer: errors of inter-prism distances, and disagreements at control points.

use nalgebra::Vector3;

use crate::deployment::ControlPointSet;
use crate::geometry::RigidTransform;
use crate::network::{Number, Pair, PerStation};
use crate::pipeline::Triplets;
use crate::statistics::median;

/// Returns the errors of the three distances of every triplet (m): apparent minus known, for pairs 12, 13, 23.
pub fn distance_errors_m(
    triplets: &Triplets,
    station1_from_station: &PerStation<RigidTransform>,
    inter_prism_m: &[f64; 3],
) -> [Vec<f64>; 3] {
    let mut errors: [Vec<f64>; 3] = std::array::from_fn(|_| Vec::with_capacity(triplets.len()));
    for found in each_distance_error_m(&triplets.points_m, station1_from_station, inter_prism_m) {
        errors.iter_mut().zip(found).for_each(|(errors, error)| errors.push(error));
    }
    errors
}

/// Returns the same errors triplet by triplet, from points by station (m, each in its station's frame).
pub fn each_distance_error_m(
    points_m: &PerStation<Vec<Vector3<f64>>>,
    station1_from_station: &PerStation<RigidTransform>,
    inter_prism_m: &[f64; 3],
) -> impl Iterator<Item = [f64; 3]> {
    (0..points_m.iter().next().map_or(0, Vec::len)).map(move |index| {
        let placed: [Vector3<f64>; 3] = std::array::from_fn(|station| {
            station1_from_station[station].apply(&points_m[station][index])
        });
        std::array::from_fn(|pair| {
            let [a, b] = Pair::at(pair).indices();
            (placed[a] - placed[b]).norm() - inter_prism_m[pair]
        })
    })
}

/// Returns the median distance between two stations' positions of a control point (m); `None` if no two stations share one.
pub fn control_points_apart_m(
    control_points: &[ControlPointSet],
    station1_from_station: &PerStation<RigidTransform>,
) -> Option<f64> {
    let sets = control_points.iter().filter(|set| !set.pillars);
    median(sets.flat_map(|set| set.disagreements_m(station1_from_station)))
}
