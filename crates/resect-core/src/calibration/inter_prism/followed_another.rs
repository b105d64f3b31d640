//! Recognition of a station that followed another prism for some time, by the distances of the rig.

use nalgebra::Vector3;

use super::PrismNetwork;
use crate::deployment::{Rig, StatedPrismChange};
use crate::geometry::RigidTransform;
use crate::network::{Number, Pair, PerStation, Prism, Station};
use crate::pipeline::Triplets;
use crate::statistics::median;

/// Largest median of the worst distance errors of the triplets with the other prism (m). Chords of bends and stops cause 20 mm; prisms of
/// the smallest rig are apart by 200 mm.
const FITS_M: f64 = 0.05;
/// Largest ratio of this median to that of any other assignment.
const DECISIVE: f64 = 0.25;
/// Time of triplets that fit the prism of before better, after which the other prism is no longer followed (s). Some fit by chance, and in
/// a gap of the readings none is accurate.
const END_S: f64 = 2.5;

/// Returns the changes to the other prism that a station followed within a span (s), and back; `None` if no other prism explains the
/// triplets there.
pub fn prism_changes(
    triplets: &Triplets,
    station1_from_station: &PerStation<RigidTransform>,
    network: &PrismNetwork,
    rig: &Rig,
    span_s: [f64; 2],
) -> Option<Vec<StatedPrismChange>> {
    let worst_m = |index: usize, network: &PrismNetwork| -> f64 {
        let placed = triplets
            .points_m
            .zip(station1_from_station, |points_m, transform| transform.apply(&points_m[index]));
        worst_error_m(network, &placed)
    };
    let first = triplets.time_s.partition_point(|t| *t < span_s[0]);
    let end = triplets.time_s.partition_point(|t| *t <= span_s[1]);
    let median_m = |network: &PrismNetwork| median((first..end).map(|k| worst_m(k, network)));
    let mut others: Vec<(f64, Station, Prism, PrismNetwork)> = Vec::new();
    let prisms = Pair::prisms_of(rig.inter_prism_m.len())?;
    for (station, usual) in network.prism_of_station.each() {
        for prism in (0..prisms).map(Prism::at).filter(|prism| prism != usual) {
            let mut followed = network.prism_of_station.clone();
            followed[station] = prism;
            let other = PrismNetwork::new(followed, &rig.inter_prism_m);
            others.push((median_m(&other)?, station, prism, other));
        }
    }
    others.sort_by(|(a_m, ..), (b_m, ..)| a_m.total_cmp(b_m));
    let (best_m, station, prism, other) = others.first()?;
    let next_m = others.get(1).map_or(f64::INFINITY, |(next_m, ..)| *next_m);
    if *best_m > FITS_M || *best_m > DECISIVE * next_m.min(median_m(network)?) {
        return None;
    }
    let is_other =
        |index: usize| (triplets.time_s[index], worst_m(index, other) < worst_m(index, network));
    let middle = usize::midpoint(first, end);
    let begin = middle + 1 - run((0..=middle).rev().map(is_other));
    let end = middle + run((middle..triplets.len()).map(is_other));
    let change = |index: usize, prism: Prism| StatedPrismChange {
        station: station.number() as u8,
        time_s: change_s(triplets, index),
        prism: prism.number() as u8,
    };
    let back = (end < triplets.len()).then(|| change(end, network.prism_of_station[*station]));
    Some(std::iter::once(change(begin, *prism)).chain(back).collect())
}

fn worst_error_m(network: &PrismNetwork, placed_m: &PerStation<Vector3<f64>>) -> f64 {
    network.errors_m(placed_m.as_slice()).fold(0.0, |worst, error_m| worst.max(error_m.abs()))
}

/// Returns the length of a run of true values, which ends once they are false for [`END_S`]; each with its time (s).
fn run(values: impl Iterator<Item = (f64, bool)>) -> usize {
    let (mut last, mut last_true_s) = (0, f64::NAN);
    for (index, (time_s, value)) in values.enumerate() {
        if value || index == 0 {
            last_true_s = time_s;
        }
        if value {
            last = index + 1;
        } else if (time_s - last_true_s).abs() >= END_S {
            break;
        }
    }
    last
}

/// Returns the time in the middle between a triplet and the one before (s).
fn change_s(triplets: &Triplets, index: usize) -> f64 {
    let before_s = triplets.time_s[index.saturating_sub(1)];
    0.5 * (before_s + triplets.time_s[index])
}
