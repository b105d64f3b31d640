//! Whether the stations followed one prism or three, read off the triplets.
//!
//! With one prism, a level alignment makes the three tracks coincide. Three prisms of a rig stay apart, because the
//! offset between them turns with the vehicle; only where the vehicle never turns does the alignment swallow it.

use nalgebra::Vector3;

use crate::deployment::{Deployment, PAIRS};
use crate::geometry::{RigidTransform, align_level};
use crate::pipeline::Triplets;
use crate::statistics::median;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Targets {
    OnePrism,
    ThreePrisms,
    /// Too little was driven, or too straight, to tell; nor does a file.
    Undecided,
}

/// Tracks of one prism lie this close after alignment (m, median): far above the noise, the chords of bends and a
/// clock some milliseconds off; far below any rig.
const COINCIDE_M: f64 = 0.05;
/// A station that is wrong for some seconds must not hide that the rest coincides: this share is aligned, so many times.
const KEPT: f64 = 0.9;
const ROUNDS: usize = 3;
/// More triplets than this say nothing new.
const MOST_TRIPLETS: usize = 2000;
const FEWEST_TRIPLETS: usize = 10;
/// Slower than this a direction of travel is noise (m/s).
const MOVING_M_PER_S: f64 = 0.1;
/// Mean of the doubled directions of travel, by how fast it goes: 1 on a line, driven either way.
const STRAIGHT: f64 = 0.9;

/// A track is about one place where half of it is within this of that place (m), further than prisms stand from the middle of a vehicle.
const AROUND_M: f64 = 3.0;

/// What `deployment.toml` says; failing that, what the tracks show; failing that, three where a rig is described.
pub fn targets(deployment: &Deployment, triplets: &Triplets) -> Targets {
    match deployment.prisms {
        Some(1) => return Targets::OnePrism,
        Some(_) => return Targets::ThreePrisms,
        None => {}
    }
    let by_rig = if deployment.rig.is_some() { Targets::ThreePrisms } else { Targets::Undecided };
    if triplets.len() < FEWEST_TRIPLETS {
        return by_rig;
    }
    if median_distance_m(triplets).is_none_or(|median_m| median_m > COINCIDE_M) {
        Targets::ThreePrisms
    } else if turns(triplets) {
        Targets::OnePrism
    } else {
        by_rig
    }
}

/// Median distance between the tracks once stations 2 and 3 are aligned to station 1.
fn median_distance_m(triplets: &Triplets) -> Option<f64> {
    let step = triplets.len().div_ceil(MOST_TRIPLETS);
    let points: [Vec<Vector3<f64>>; 3] =
        triplets.points_m.each_ref().map(|points| points.iter().step_by(step).copied().collect());
    let [a, b, c] = &points;
    let placed = [a.clone(), aligned(a, b)?, aligned(a, c)?];
    let pairs = PAIRS.iter().flat_map(|(a, b)| placed[*a].iter().zip(&placed[*b]));
    median(pairs.map(|(a, b)| (a - b).norm()))
}

/// A track aligned to that of station 1, again and again without what lies furthest off.
fn aligned(to_m: &[Vector3<f64>], from_m: &[Vector3<f64>]) -> Option<Vec<Vector3<f64>>> {
    let mut aligned = RigidTransform::from(align_level(to_m, from_m)?);
    let keep = (KEPT * to_m.len() as f64).ceil() as usize;
    for _ in 0..ROUNDS {
        let pairs = to_m.iter().zip(from_m);
        let off_m: Vec<f64> =
            pairs.map(|(to_m, from_m)| (to_m - aligned.apply(from_m)).norm()).collect();
        let mut kept: Vec<usize> = (0..to_m.len()).collect();
        kept.sort_by(|a, b| off_m[*a].total_cmp(&off_m[*b]));
        kept.truncate(keep);
        let [to_m, from_m] = [to_m, from_m]
            .map(|points| kept.iter().map(|index| points[*index]).collect::<Vec<_>>());
        aligned = align_level(&to_m, &from_m)?.into();
    }
    Some(from_m.iter().map(|point_m| aligned.apply(point_m)).collect())
}

/// Whether the direction of travel varies along the way; there and back along a line does not count, nor does a turn on the spot after
/// a long line, in which prisms go every way and hardly anywhere. A reading that is metres off counts no more than others.
fn turns(triplets: &Triplets) -> bool {
    let points = &triplets.points_m[0];
    let moves = (1..triplets.len()).filter(|i| {
        triplets.interval[*i] == triplets.interval[i - 1]
            && triplets.speed_m_per_s[*i] > MOVING_M_PER_S
    });
    let moves: Vec<usize> = moves.collect();
    let speeds = moves.iter().map(|i| triplets.speed_m_per_s[*i]);
    let Some(usual_m_per_s) = median(speeds) else { return false };
    let (mut cos, mut sin, mut all) = (0.0, 0.0, 0.0);
    for i in &moves {
        let way = points[*i] - points[i - 1];
        let doubled = 2.0 * way.y.atan2(way.x);
        let weight = triplets.speed_m_per_s[*i].min(usual_m_per_s);
        cos += weight * doubled.cos();
        sin += weight * doubled.sin();
        all += weight;
    }
    let places_m: Vec<&Vector3<f64>> = moves.iter().map(|i| &points[*i]).collect();
    f64::hypot(cos, sin) < STRAIGHT * all && !stays(&places_m)
}

/// Whether a vehicle stays about one place while it moves: prisms that it turns around on the spot go around the same circle, and an
/// alignment makes one of them the other.
fn stays(places_m: &[&Vector3<f64>]) -> bool {
    let middle = |axis: usize| median(places_m.iter().map(|at| at[axis])).unwrap_or(0.0);
    let middle_m = Vector3::new(middle(0), middle(1), middle(2));
    median(places_m.iter().map(|at| (*at - middle_m).norm())).is_none_or(|m| m < AROUND_M)
}
