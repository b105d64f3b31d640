//! Misfits of an answer: errors of inter-prism distances, and disagreements at control points.

use crate::deployment::ControlPointSet;
use crate::geometry::RigidTransform;
use crate::network::{Pair, PerPair, PerStation};
use crate::pipeline::Triplets;
use crate::statistics::median;

/// Returns the errors of the distances between the stations' prisms, for every pair of stations and every triplet (m): apparent
/// minus known.
///
/// Each station follows the prism with its number, or all stations follow one prism, whose known distances are zero. Pairs without
/// a known distance are left out.
pub fn distance_errors_m(
    triplets: &Triplets,
    station1_from_station: &PerStation<RigidTransform>,
    known_m: &PerPair<f64>,
) -> PerPair<Vec<f64>> {
    let placed = station1_from_station.zip(&triplets.points_m, |transform, points_m| {
        points_m.iter().map(|point_m| transform.apply(point_m)).collect::<Vec<_>>()
    });
    let pairs = Pair::among(placed.len()).map(Pair::indices).zip(known_m);
    pairs
        .map(|([a, b], known_m)| {
            placed[a].iter().zip(&placed[b]).map(|(a, b)| (a - b).norm() - known_m).collect()
        })
        .collect()
}

/// Returns the median distance between two stations' positions of a control point (m); `None` if no two stations share one.
pub fn control_points_apart_m(
    control_points: &[ControlPointSet],
    station1_from_station: &PerStation<RigidTransform>,
) -> Option<f64> {
    let sets = control_points.iter().filter(|set| !set.pillars);
    median(sets.flat_map(|set| set.disagreements_m(station1_from_station)))
}
