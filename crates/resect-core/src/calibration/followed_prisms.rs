//! Decides from the triplets if the stations followed one prism, or each its own.
//!
//! With one prism, a level alignment makes the tracks coincide. Prisms of a rig stay apart, because the offset between
//! them rotates with the vehicle. If the vehicle never turns, the alignment absorbs the offset.

use nalgebra::Vector3;

use crate::deployment::Deployment;
use crate::geometry::{RigidTransform, align_level, wrap_to_pi};
use crate::network::{PerStation, Prism, PrismSchedule};
use crate::pipeline::Triplets;
use crate::statistics::median;

/// The prism that each station follows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PrismAssignment {
    pub by_station: PerStation<Prism>,
    /// True if the drive is too short or too straight to decide if all stations follow one prism, and no file states it. Each station
    /// has a prism of its own then.
    pub is_undecided: bool,
}

/// Largest median distance between tracks of one prism after alignment (m). Noise, chords of bends and clock offsets of some
/// milliseconds cause far less; any rig is far larger.
const COINCIDE_M: f64 = 0.05;
/// Share of the triplets that is aligned, so that a station with outliers for some seconds does not hide that the rest coincides.
const KEPT: f64 = 0.9;
/// Rounds of alignment, each with the triplets that fit best.
const ROUNDS: usize = 3;
/// Distance that the prism of some station moves from place to place (m): much more than noise. A vehicle that stands for minutes is at one
/// place, at which any tracks coincide.
const PLACE_M: f64 = 0.2;
/// Most places that are used; more add no information.
const MOST_PLACES: usize = 2000;
/// Fewest places from which coinciding tracks are recognised.
const FEWEST_PLACES: usize = 10;
/// Length of the chords by which the direction of travel is measured (m): much longer than noise, shorter than bends.
const CHORD_M: f64 = 1.0;
/// Share of the chords that count.
const KEPT_CHORDS: f64 = 0.85;
/// Distance of two prisms on the smallest rig (m).
const SMALLEST_RIG_M: f64 = 0.2;
/// Multiple of the median distance by which the prisms of the smallest rig would be apart.
const APART: f64 = 3.0;
/// Least spread of directions that is needed (rad): noise of chords.
const LEAST_SPREAD_RAD: f64 = 0.06;
/// Largest spread of directions that is needed (rad): a drive that turns has it.
const MOST_SPREAD_RAD: f64 = 0.23;

/// A track whose median distance from its centre is smaller stays at one place (m). Prisms are nearer to the middle of a vehicle.
const AROUND_M: f64 = 3.0;

/// Returns the prisms by `deployment.toml` (at the first triplet, if they change), else by the tracks, else one for each station if a rig is described.
pub fn followed_prisms(deployment: &Deployment, triplets: &Triplets) -> PrismAssignment {
    let several = |is_undecided: bool| PrismAssignment {
        by_station: several_prisms(deployment, triplets),
        is_undecided,
    };
    let one = || PrismAssignment { by_station: one_prism(deployment), is_undecided: false };
    if !deployment.prism_schedule().is_constant() {
        return several(false);
    }
    match deployment.prisms {
        Some(1) => return one(),
        Some(_) => return several(false),
        None => {}
    }
    let by_rig = || several(deployment.rig.is_none());
    let places = distinct_places(triplets);
    if places.len() < FEWEST_PLACES {
        return by_rig();
    }
    match median_distance_m(triplets, &places).filter(|median_m| *median_m < COINCIDE_M) {
        None => several(false),
        Some(median_m) if turns(triplets, median_m) => one(),
        Some(_) => by_rig(),
    }
}

/// Returns the prisms over time of stations that follow these by [`followed_prisms`].
pub fn schedule(deployment: &Deployment, followed: &PerStation<Prism>) -> PrismSchedule {
    let stated = deployment.prism_schedule();
    if stated.is_constant() { PrismSchedule::constant(followed.clone()) } else { stated }
}

/// Returns the same prism for all stations.
pub fn one_prism(deployment: &Deployment) -> PerStation<Prism> {
    deployment.tracks.map(|_| Prism::default())
}

/// Returns the stated prisms at the first triplet, else one for each station.
pub fn several_prisms(deployment: &Deployment, triplets: &Triplets) -> PerStation<Prism> {
    let time_s = triplets.time_s.first().copied().unwrap_or(f64::NEG_INFINITY);
    deployment.prism_schedule().at(time_s).clone()
}

/// Returns the triplets at which the vehicle has moved since the one before.
fn distinct_places(triplets: &Triplets) -> Vec<usize> {
    let mut places: Vec<usize> = Vec::new();
    for index in 0..triplets.len() {
        let has_moved = |last: &usize| {
            let mut tracks = triplets.points_m.iter();
            tracks.any(|points_m| (points_m[index] - points_m[*last]).norm() > PLACE_M)
        };
        if places.last().is_none_or(has_moved) {
            places.push(index);
        }
    }
    places
}

/// Returns the median distance between the tracks at these places after the others are aligned to that of station 1 (m).
fn median_distance_m(triplets: &Triplets, places: &[usize]) -> Option<f64> {
    let step = places.len().div_ceil(MOST_PLACES);
    let at_places = || places.iter().step_by(step);
    let points: PerStation<Vec<Vector3<f64>>> =
        triplets.points_m.map(|points| at_places().map(|index| points[*index]).collect());
    let (first, others) = points.as_slice().split_first()?;
    let mut placed = vec![first.clone()];
    for other in others {
        placed.push(aligned(first, other)?);
    }
    let pairs = placed.iter().enumerate().flat_map(|(before, own)| {
        placed[..before].iter().flat_map(move |other| other.iter().zip(own))
    });
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

/// Returns true if the direction of travel varies so much that the prisms of the smallest rig would be apart by several times the
/// median distance of the aligned tracks (m).
///
/// A rotation on the spot after a long line is not a turn: prisms then move in all directions but hardly change place.
fn turns(triplets: &Triplets, median_m: f64) -> bool {
    let places_m = places_m(triplets);
    let needed_rad = (APART * median_m / SMALLEST_RIG_M).clamp(LEAST_SPREAD_RAD, MOST_SPREAD_RAD);
    let spread_rad = direction_spread_rad(&places_m);
    spread_rad.is_some_and(|spread_rad| spread_rad > needed_rad) && !stays(&places_m)
}

/// Returns places along the track of station 1, each a chord from the one before, by interval (m).
fn places_m(triplets: &Triplets) -> Vec<Vec<Vector3<f64>>> {
    let points_m = &triplets.points_m[0];
    let mut places_m: Vec<Vec<Vector3<f64>>> = Vec::new();
    for i in 0..points_m.len() {
        if i == 0 || triplets.interval[i] != triplets.interval[i - 1] {
            places_m.push(Vec::new());
        }
        let Some(own) = places_m.last_mut() else { continue };
        let point_m = smoothed_m(points_m, i);
        if own.last().is_none_or(|last| (point_m - last).xy().norm() > CHORD_M) {
            own.push(point_m);
        }
    }
    places_m
}

/// Returns the median of a point and its neighbours, by coordinate (m), which no single outlier moves.
fn smoothed_m(points_m: &[Vector3<f64>], index: usize) -> Vector3<f64> {
    let around = &points_m[index.saturating_sub(2)..(index + 3).min(points_m.len())];
    Vector3::from_fn(|axis, _| median(around.iter().map(|point| point[axis])).unwrap_or(0.0))
}

/// Returns the root mean square deviation of the direction of travel from its mean (rad); `None` without chords.
///
/// Directions are doubled, so that a line driven in both directions has no spread. The most deviating chords are left out, because
/// outliers turn them.
fn direction_spread_rad(places_m: &[Vec<Vector3<f64>>]) -> Option<f64> {
    let ways = places_m.iter().flat_map(|own| own.windows(2)).map(|chord| chord[1] - chord[0]);
    // An outlier of metres makes two longer chords.
    let ways = ways.filter(|way| way.xy().norm() < 2.0 * CHORD_M);
    let doubled_rad: Vec<f64> = ways.map(|way| 2.0 * way.y.atan2(way.x)).collect();
    let (sin, cos) = doubled_rad.iter().fold((0.0, 0.0), |(sin, cos), doubled_rad| {
        (sin + doubled_rad.sin(), cos + doubled_rad.cos())
    });
    let mean_rad = f64::atan2(sin, cos);
    let deviation_rad = |doubled_rad: &f64| 0.5 * wrap_to_pi(doubled_rad - mean_rad).abs();
    let mut deviations_rad: Vec<f64> = doubled_rad.iter().map(deviation_rad).collect();
    deviations_rad.sort_by(f64::total_cmp);
    deviations_rad.truncate((KEPT_CHORDS * deviations_rad.len() as f64).floor() as usize);
    let squares: f64 = deviations_rad.iter().map(|deviation_rad| deviation_rad.powi(2)).sum();
    (!deviations_rad.is_empty()).then(|| (squares / deviations_rad.len() as f64).sqrt())
}

/// Returns true if a vehicle moves only at one place. Prisms that it turns around on the spot follow the same circle, so an
/// alignment maps one onto the other.
fn stays(places_m: &[Vec<Vector3<f64>>]) -> bool {
    let all = || places_m.iter().flatten();
    let middle = |axis: usize| median(all().map(|place_m| place_m[axis])).unwrap_or(0.0);
    let middle_m = Vector3::new(middle(0), middle(1), middle(2));
    let distances_m = all().map(|place_m| (*place_m - middle_m).norm());
    median(distances_m).is_none_or(|median_m| median_m < AROUND_M)
}
