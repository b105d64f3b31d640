//! Misfits of an answer: errors of inter-prism distances, and disagreements at control points.

use nalgebra::Vector3;

use crate::deployment::ControlPointSet;
use crate::geometry::RigidTransform;
use crate::network::{PerPair, PerPrism, PerStation, Prism, Station};
use crate::pipeline::Triplets;
use crate::statistics::median;

/// Returns the errors of the distances between prisms, for every pair of prisms and every triplet (m): apparent minus known.
///
/// If all stations follow one prism, the pairs are those of the stations, with known distances of zero. Pairs without a known distance
/// are left out.
pub fn distance_errors_m(
    triplets: &Triplets,
    station1_from_station: &PerStation<RigidTransform>,
    followed: &PerStation<Prism>,
    known_m: &PerPair<f64>,
) -> PerPair<Vec<f64>> {
    let count = triplets.len();
    let mut errors_m: PerPair<Vec<f64>> = known_m.map(|_| Vec::with_capacity(count));
    for index in 0..count {
        let placed_m = placed_m(triplets, station1_from_station, index);
        let prisms_m = if Prism::is_one(followed) {
            placed_m.into_iter().collect()
        } else {
            prisms_m(&placed_m, followed)
        };
        for ((pair, known_m), errors_m) in known_m.each().zip(&mut errors_m) {
            if let (Some(a), Some(b)) = (prisms_m.get(pair.first), prisms_m.get(pair.second)) {
                errors_m.push((a - b).norm() - known_m);
            }
        }
    }
    errors_m
}

/// Returns a station for each position that [`distance_errors_m`] compares: the first one that follows a prism, or each if all follow one.
pub fn compared_stations(followed: &PerStation<Prism>) -> PerPrism<Station> {
    if Prism::is_one(followed) {
        return followed.numbers().collect();
    }
    let first = |prism: Prism| followed.each().find(|(_, own)| **own == prism);
    PerPrism::from_fn(Prism::count(followed), |prism| {
        first(prism).map_or(Station::FIRST, |(station, _)| station)
    })
}

/// Returns the positions of the stations' prisms at a triplet (m, station 1's frame).
pub fn placed_m(
    triplets: &Triplets,
    station1_from_station: &PerStation<RigidTransform>,
    index: usize,
) -> PerStation<Vector3<f64>> {
    let points_m = &triplets.points_m;
    station1_from_station.zip(points_m, |transform, points_m| transform.apply(&points_m[index]))
}

/// Returns the positions of the prisms: the mean over the stations that follow the same one (m).
pub fn prisms_m(
    placed_m: &PerStation<Vector3<f64>>,
    followed: &PerStation<Prism>,
) -> PerPrism<Vector3<f64>> {
    PerPrism::from_fn(Prism::count(followed), |prism| {
        let own = || followed.iter().zip(placed_m).filter(|(own, _)| **own == prism);
        let sum_m: Vector3<f64> = own().map(|(_, placed_m)| placed_m).sum();
        sum_m / own().count() as f64
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
