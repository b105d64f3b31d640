//! What to drive next: manoeuvres from where the vehicle is now, by what they would add to what is read already.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use nalgebra::{Rotation2, SMatrix, Vector2, Vector3};
use rayon::prelude::*;

use super::drive::drive_with;
use super::manoeuvres::{FigureEight, Loop, slalom_m};
use super::past::AsDriven;
use super::plan::{Ground, Instrument, Plan, Rig};
use super::way::{Piece, Waypoint};
use crate::calibration::ErrorSizes;
use crate::calibration::inter_prism::{self, observability::Hold, observability::Observability};
use crate::calibration::joint::{self, Expected};
use crate::deployment::pairwise_distances;
use crate::evaluation::far_end::{FarEnd, far_end};
use crate::geometry::{LevelTransform, RigidTransform};
use crate::pipeline::{FilteredTrack, Thresholds, Triplets};
use crate::progress::{Cancelled, Progress};

/// Tips of the figure-eights that are tried are so far apart (m).
const EIGHTS_M: [f64; 2] = [16.0, 28.0];
const LOOP_RADIUS_M: f64 = 6.0;
/// How far straight legs lead (m).
const LEG_M: f64 = 25.0;
/// A pass near the stations leads this near to their middle (m).
const NEAR_M: f64 = 15.0;
/// Directions are told from places this far apart (m).
const HEADING_M: f64 = 0.5;
/// Between what was read and what is tried (s).
const PAUSE_S: f64 = 1.0;
/// Places at which the far end is looked for, by station.
const MOST_PLACES: usize = 300;

/// A drive in progress.
#[derive(Clone, Copy, Debug)]
pub struct SoFar<'a> {
    /// What the pipeline makes of the readings so far.
    pub triplets: &'a Triplets,
    /// Where the stations are, as far as it is known: any answer does.
    pub station1_from_station: &'a [LevelTransform; 3],
    /// Prisms in any frame of the vehicle; all the same where all stations follow one.
    pub prisms_m: &'a [Vector3<f64>; 3],
    /// How large errors are, with that of the rig's distances ([`ErrorSizes::inter_prism_m`]).
    pub sizes: &'a ErrorSizes,
    /// How noisy readings are: as an estimate learned it, or as is usual.
    pub expected: Expected,
    /// Readings per second of each station.
    pub rate_hz: f64,
    pub thresholds: Thresholds,
    /// Further places at which the vehicle is to be known, in the frame of station 1: where it will work.
    pub places_m: &'a [Vector3<f64>],
    /// Largest root mean square error at the far end that is wanted.
    pub target_m: f64,
    pub speed_m_per_s: f64,
    pub turn_radius_m: f64,
}

/// What a drive in progress holds.
#[derive(Clone, Debug)]
pub struct Known {
    /// What is open at the far end now; `None` where a direction is free.
    pub far_end: Option<FarEnd>,
    /// What the drive holds so far; `None` of one prism.
    pub observability: Option<Observability>,
    /// Whether the target is met, and no direction is free or weak.
    pub is_enough: bool,
}

/// What is known of a drive in progress, and what to drive next.
#[derive(Clone, Debug)]
pub struct Advice {
    pub now: Known,
    /// What gains most in a second comes first, and as long as a direction is free, what leaves the fewest open; what gains
    /// nothing is left out.
    pub moves: Vec<NextMove>,
}

/// A manoeuvre from where the vehicle is.
#[derive(Clone, Debug)]
pub struct NextMove {
    /// "drive a figure-eight of 16 m here: 3.1 → 1.6 mm in 40 s".
    pub sentence: String,
    /// The way in the frame of station 1, from where the vehicle is.
    pub waypoints_m: Vec<Vector2<f64>>,
    /// What is open at the far end afterwards (m).
    pub after_m: f64,
    pub takes_s: f64,
    /// How many of the eight directions are still free or weak then.
    pub open: usize,
    /// How much more is known at the far end, by time (1/σ², 1/m²/s): what is known adds up, which σ does not.
    pub gain_per_m2_s: f64,
}

/// What the readings so far hold, and whether they are enough.
///
/// `covariance` is what the joint estimate of them leaves open of (x, y, z, yaw) of stations 2 and 3, where there is one; what is
/// foreseen takes its place otherwise, which knows of no steps of stations and no jumps of clocks.
pub fn known(
    so_far: &SoFar<'_>,
    covariance: Option<&SMatrix<f64, 8, 8>>,
    progress: &Progress,
) -> Result<Known, Cancelled> {
    let found = foreseen(so_far, so_far.triplets, progress)?;
    let places_m = places_m(so_far);
    let covariance = found.held.map(|foreseen| covariance.copied().unwrap_or(foreseen));
    let far_end = covariance.and_then(|open| far_end(&rigid(so_far), &open, &places_m));
    let is_steady = found.observability.as_ref().is_none_or(|seen| seen.count(Hold::Held) == 8);
    let is_met = far_end.is_some_and(|far_end| far_end.sigma_m <= so_far.target_m);
    Ok(Known { far_end, observability: found.observability, is_enough: is_steady && is_met })
}

/// What to drive next. `None` where the readings so far say of no vehicle that it moves.
pub fn what_next(so_far: &SoFar<'_>, progress: &Progress) -> Result<Option<Advice>, Cancelled> {
    let Some(here) = Here::of(so_far) else { return Ok(None) };
    let now = known(so_far, None, progress)?;
    let places_m = places_m(so_far);
    let transforms = rigid(so_far);
    let look = |triplets: &Triplets| -> Result<(Option<f64>, usize), Cancelled> {
        let found = foreseen(so_far, triplets, progress)?;
        let far = found.held.and_then(|covariance| far_end(&transforms, &covariance, &places_m));
        let open = found.observability.map_or(0, |seen| 8 - seen.count(Hold::Held));
        Ok((far.map(|far| far.sigma_m), open))
    };
    // What is foreseen is compared with what is foreseen.
    let (before_m, _) = look(so_far.triplets)?;
    let one = |(what, way_m): (String, Vec<Vector2<f64>>)| {
        let Some((triplets, takes_s)) = here.driven(so_far, &way_m) else { return Ok(None) };
        let (Some(after_m), open) = look(&triplets)? else { return Ok(None) };
        let known = |sigma_m: f64| sigma_m.powi(-2);
        let gain_per_m2_s = (known(after_m) - before_m.map_or(0.0, known)) / takes_s.max(1.0);
        let before = before_m.map_or("free".to_owned(), |m| format!("{:.1}", m * 1e3));
        let sentence = format!("{what}: {before} → {:.1} mm in {takes_s:.0} s", after_m * 1e3);
        let found =
            NextMove { sentence, waypoints_m: way_m, after_m, takes_s, open, gain_per_m2_s };
        Ok((gain_per_m2_s > 0.0).then_some(found))
    };
    let tried = here.candidates(so_far).into_par_iter().map(one);
    let tried: Vec<Option<NextMove>> = tried.collect::<Result<_, Cancelled>>()?;
    let mut moves: Vec<NextMove> = tried.into_iter().flatten().collect();
    moves.sort_by(|a, b| a.open.cmp(&b.open).then(b.gain_per_m2_s.total_cmp(&a.gain_per_m2_s)));
    Ok(Some(Advice { now, moves }))
}

/// What some readings hold.
struct Foreseen {
    held: Option<SMatrix<f64, 8, 8>>,
    observability: Option<Observability>,
}

fn foreseen(
    so_far: &SoFar<'_>,
    triplets: &Triplets,
    progress: &Progress,
) -> Result<Foreseen, Cancelled> {
    let SoFar { station1_from_station, sizes, expected, .. } = so_far;
    let inter_prism_m = pairwise_distances(so_far.prisms_m);
    let is_rig = inter_prism_m.iter().all(|distance_m| *distance_m > 0.0);
    let distances_m = is_rig.then_some(&inter_prism_m);
    let estimate =
        joint::foresee(triplets, station1_from_station, distances_m, sizes, expected, progress)?;
    let covariance = estimate.map(|estimate| estimate.covariance);
    let seen = distances_m.and_then(|distances_m| {
        inter_prism::foresee(triplets, distances_m, station1_from_station, covariance)
    });
    let held = covariance.filter(|_| seen.as_ref().is_none_or(|seen| seen.is_held));
    Ok(Foreseen { held, observability: seen.map(|seen| seen.observability) })
}

fn rigid(so_far: &SoFar<'_>) -> [RigidTransform; 3] {
    so_far.station1_from_station.map(RigidTransform::from)
}

/// Where the far end is looked for: along the track so far, and at the places that are named, by station in its own frame.
fn places_m(so_far: &SoFar<'_>) -> [Vec<Vector3<f64>>; 3] {
    let step = (so_far.triplets.len() / MOST_PLACES).max(1);
    std::array::from_fn(|station| {
        let own = so_far.triplets.points_m[station].iter().step_by(step).copied();
        let station_from_station1 = so_far.station1_from_station[station].inverse();
        let named = so_far.places_m.iter().map(|place_m| station_from_station1.apply(place_m));
        own.chain(named).collect()
    })
}

/// The vehicle where it is now.
struct Here {
    place_m: Vector2<f64>,
    along: Vector2<f64>,
    /// Where it was, some places after another.
    driven_m: Vec<Vector2<f64>>,
    as_driven: AsDriven,
    ground_m: f64,
}

impl Here {
    fn of(so_far: &SoFar<'_>) -> Option<Self> {
        let triplets = so_far.triplets;
        let placed = |index: usize| -> [Vector3<f64>; 3] {
            let points_m = triplets.triplet_m(index);
            std::array::from_fn(|station| {
                so_far.station1_from_station[station].apply(&points_m[station])
            })
        };
        let all_m: Vec<[Vector3<f64>; 3]> = (0..triplets.len()).map(placed).collect();
        let middle_m = |at: &[Vector3<f64>; 3]| (at[0] + at[1] + at[2]) / 3.0;
        let last_m = middle_m(all_m.last()?);
        let before = all_m.iter().rev().map(|at| (last_m - middle_m(at)).xy());
        let along = before.into_iter().find(|gone_m| gone_m.norm() > HEADING_M)?.normalize();
        let as_driven = if pairwise_distances(so_far.prisms_m).contains(&0.0) {
            AsDriven { prisms_m: [Vector3::zeros(); 3], slope_rms_rad: 0.0 }
        } else {
            AsDriven::of(so_far.prisms_m, &triplets.time_s, &all_m)?
        };
        let step = (all_m.len() / MOST_PLACES).max(1);
        let driven_m = all_m.iter().step_by(step).map(|at| middle_m(at).xy()).collect();
        Some(Self { place_m: last_m.xy(), along, driven_m, as_driven, ground_m: last_m.z })
    }

    /// Manoeuvres from here, in words and as ways in the frame of station 1.
    fn candidates(&self, so_far: &SoFar<'_>) -> Vec<(String, Vec<Vector2<f64>>)> {
        let heading_rad = self.along.y.atan2(self.along.x);
        let mut all = Vec::new();
        for length_m in EIGHTS_M {
            let centre_m = self.place_m.into();
            let eight = FigureEight { centre_m, length_m, heading_rad, times: 1 };
            all.push((format!("drive a figure-eight of {length_m:.0} m here"), eight.places_m()));
        }
        for (side, hand) in [(1.0, "left"), (-1.0, "right")] {
            let centre_m = self.place_m + self.turned(side * FRAC_PI_2) * LOOP_RADIUS_M;
            let from_rad = heading_rad - side * FRAC_PI_2;
            let (centre_m, radius_m) = (centre_m.into(), LOOP_RADIUS_M);
            let one = Loop { centre_m, radius_m, from_rad, turns: side };
            let across_m = 2.0 * LOOP_RADIUS_M;
            all.push((format!("drive a loop of {across_m:.0} m to the {hand}"), one.places_m()));
        }
        let mut to = |to_m: Vector2<f64>, where_to: &str| {
            all.push((format!("drive straight {where_to}"), vec![self.place_m, to_m]));
            all.push((
                format!("drive a slalom {where_to}"),
                slalom_m(self.place_m, to_m, &self.along),
            ));
        };
        for (turn_rad, way) in
            [(0.0, "ahead"), (FRAC_PI_2, "to the left"), (-FRAC_PI_2, "to the right"), (PI, "back")]
        {
            let to_m = self.place_m + self.turned(turn_rad) * LEG_M;
            to(to_m, &format!("{way} for {LEG_M:.0} m"));
        }
        let stations = so_far.station1_from_station.map(|at| at.translation_m.xy());
        let middle_m = (stations[0] + stations[1] + stations[2]) / 3.0;
        let away_m = self.place_m - middle_m;
        if away_m.norm() > NEAR_M + LEG_M / 2.0 {
            let near_m = middle_m + away_m.normalize() * NEAR_M;
            to(near_m, &format!("to {NEAR_M:.0} m from the stations"));
        }
        if let Some(far_m) = self.least_visited_m(so_far)
            && (far_m - self.place_m).norm() > LEG_M / 4.0
        {
            to(far_m, &format!("to ({:.0}, {:.0}), where it was not yet", far_m.x, far_m.y));
        }
        all
    }

    /// Of the places where the vehicle is to be known, the one that is furthest from all that was driven.
    fn least_visited_m(&self, so_far: &SoFar<'_>) -> Option<Vector2<f64>> {
        let away_m = |place_m: &Vector2<f64>| {
            let driven_m = self.driven_m.iter().map(|at| (at - place_m).norm());
            driven_m.fold(f64::INFINITY, f64::min)
        };
        let places_m = so_far.places_m.iter().map(Vector3::xy);
        places_m.max_by(|a, b| away_m(a).total_cmp(&away_m(b)))
    }

    fn turned(&self, by_rad: f64) -> Vector2<f64> {
        Rotation2::new(by_rad) * self.along
    }

    /// The triplets so far with those of a manoeuvre, and how long it takes (s).
    fn driven(&self, so_far: &SoFar<'_>, way_m: &[Vector2<f64>]) -> Option<(Triplets, f64)> {
        let [_, second, third] = so_far.station1_from_station;
        let rig = Rig { prisms_m: self.as_driven.prisms_m, ..Rig::default() };
        let plan = Plan {
            speed_m_per_s: so_far.speed_m_per_s,
            turn_radius_m: so_far.turn_radius_m,
            stations_m: so_far.station1_from_station.map(|at| at.translation_m),
            ground: Ground {
                height_m: self.ground_m,
                slope_rms_rad: self.as_driven.slope_rms_rad,
                ..Ground::default()
            },
            rig,
            instrument: Instrument { rate_hz: so_far.rate_hz, ..Instrument::default() },
            thresholds: so_far.thresholds,
            // The vehicle heads as it does, wherever it is to go.
            way: vec![Piece::Waypoints(
                std::iter::once(self.place_m - self.along * HEADING_M)
                    .chain(way_m.iter().copied())
                    .map(Waypoint::at)
                    .collect(),
            )],
            ..Plan::default()
        };
        let driven = drive_with(&plan, [second.yaw_rad, third.yaw_rad]).ok()?;
        let takes_s = driven.simulated.scenario.duration_s;
        Some((joined(so_far.triplets, &driven.pipeline.triplets), takes_s))
    }
}

/// Triplets and, after a pause, those of a drive that begins where they end.
fn joined(so_far: &Triplets, next: &Triplets) -> Triplets {
    let begins_s = next.time_s.first().copied().unwrap_or_default();
    let later_s = so_far.time_s.last().map_or(0.0, |last_s| last_s + PAUSE_S - begins_s);
    let intervals = so_far.interval.last().map_or(0, |last| last + 1);
    let times_s = |all: &[f64]| all.iter().map(|t| t + later_s).collect::<Vec<_>>();
    let track = |station: usize| {
        let (own, more) = (&so_far.readings[station], &next.readings[station]);
        // What a station read last in a gap of the others lies after what is tried: it tells nothing.
        let before = own.time_s.partition_point(|t| *t < begins_s + later_s);
        FilteredTrack {
            time_s: [own.time_s[..before].to_vec(), times_s(&more.time_s)].concat(),
            position_m: [&own.position_m[..before], &more.position_m].concat(),
            ..FilteredTrack::default()
        }
    };
    let points_m =
        [0, 1, 2].map(|station| [&so_far.points_m[station][..], &next.points_m[station]].concat());
    let interval = next.interval.iter().map(|interval| interval + intervals);
    let mut joined = Triplets::new(
        [so_far.time_s.clone(), times_s(&next.time_s)].concat(),
        so_far.interval.iter().copied().chain(interval).collect(),
        points_m,
    );
    joined.restarts_s.clone_from(&so_far.restarts_s);
    joined.readings = Arc::new([track(0), track(1), track(2)]);
    joined
}
