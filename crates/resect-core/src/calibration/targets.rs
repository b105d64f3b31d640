//! Decides from the triplets if the stations followed one prism or three.
//!
//! With one prism, a level alignment makes the three tracks coincide. Three prisms of a rig stay apart, because the offset between
//! them rotates with the vehicle. If the vehicle never turns, the alignment absorbs the offset.

use nalgebra::Vector3;

use crate::deployment::{Deployment, PAIRS};
use crate::geometry::{RigidTransform, align_level};
use crate::pipeline::Triplets;
use crate::statistics::median;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Targets {
    OnePrism,
    ThreePrisms,
    /// Undecided: the drive is too short or too straight, and no file states the number of prisms.
    Undecided,
}

/// Largest median distance between tracks of one prism after alignment (m). Noise, chords of bends and clock offsets of some
/// milliseconds cause far less; any rig is far larger.
const COINCIDE_M: f64 = 0.05;
/// Share of the triplets that is aligned, and number of rounds, so that a station with outliers for some seconds does not hide that
/// the rest coincides.
const KEPT: f64 = 0.9;
const ROUNDS: usize = 3;
/// Most triplets that are used; more add no information.
const MOST_TRIPLETS: usize = 2000;
const FEWEST_TRIPLETS: usize = 10;
/// Below this speed the direction of travel is noise (m/s).
const MOVING_M_PER_S: f64 = 0.1;
/// Largest length of the mean of doubled directions of travel, weighted by speed, of a drive that turns. It is 1 on a line driven
/// in one or both directions.
const STRAIGHT: f64 = 0.9;

/// A track whose median distance from its centre is smaller stays at one place (m). Prisms are nearer to the middle of a vehicle.
const AROUND_M: f64 = 3.0;

/// Returns the targets by `deployment.toml`, else by the tracks, else three prisms if a rig is described.
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

/// Returns the median distance between the tracks after stations 2 and 3 are aligned to station 1 (m).
fn median_distance_m(triplets: &Triplets) -> Option<f64> {
    let step = triplets.len().div_ceil(MOST_TRIPLETS);
    let points: [Vec<Vector3<f64>>; 3] =
        triplets.points_m.each_ref().map(|points| points.iter().step_by(step).copied().collect());
    let [a, b, c] = &points;
    let placed = [a.clone(), aligned(a, b)?, aligned(a, c)?];
    let pairs = PAIRS.iter().flat_map(|(a, b)| placed[*a].iter().zip(&placed[*b]));
    median(pairs.map(|(a, b)| (a - b).norm()))
}

/// Aligns a track to that of station 1, repeatedly without the points that fit worst.
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

/// Returns true if the direction of travel varies along the track.
///
/// A line driven in both directions is not a turn. A rotation on the spot after a long line is not one either: prisms then move in
/// all directions but hardly change place. Weights are limited, so that a reading with an error of metres weighs no more than
/// others.
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

/// Returns true if a vehicle moves only at one place. Prisms that it turns around on the spot follow the same circle, so an
/// alignment maps one onto the other.
fn stays(places_m: &[&Vector3<f64>]) -> bool {
    let middle = |axis: usize| median(places_m.iter().map(|at| at[axis])).unwrap_or(0.0);
    let middle_m = Vector3::new(middle(0), middle(1), middle(2));
    median(places_m.iter().map(|at| (*at - middle_m).norm())).is_none_or(|m| m < AROUND_M)
}
