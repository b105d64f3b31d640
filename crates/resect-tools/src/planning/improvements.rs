//! Improvements of a plan: candidate changes are simulated one by one and ranked.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{DMatrix, Rotation2, Vector2, Vector3};
use rayon::prelude::*;

use super::corridor::Corridor;
use super::manoeuvres::{EIGHTS_M, FigureEight, LOOP_RADIUS_M, Loop, NEAR_M, once_around_m};
use super::plan::Plan;
use super::predict::{Looked, look};
use super::prediction::PlanError;
use super::way::Piece;
use crate::simulation::{Ramp, Waypoint};
use resect_core::evaluation::far_end::far_end;
use resect_core::geometry::RigidTransform;
use resect_core::network::{Number, PerStation};
use resect_core::progress::Progress;

const RAMP: Ramp = Ramp { centre_m: [0.0; 2], radius_m: 4.0, height_m: 0.45 };
/// Change of a prism's height, up and down (m).
const MAST_M: f64 = 0.4;
/// Lowest place of a prism (m). The vehicle of a recorded drive has its origin between the prisms, because its ground is
/// unknown, so its prisms are only raised.
const LOWEST_PRISM_M: f64 = 0.1;
/// Displacement of a station (m), and its number of directions.
const STEP_M: f64 = 10.0;
const DIRECTIONS: u32 = 4;
/// Smallest relative gain that is reported.
const LEAST_GAIN: f64 = 0.02;
/// Largest number of positions at which the far-end error is evaluated, by station.
const MOST_PLACES: usize = 300;

/// A change of a plan that reduces the error at the far end of its track.
#[derive(Clone, Debug)]
pub struct Improvement {
    pub kind: ImprovementKind,
    /// "a figure-eight of 16 m at the far end: 3.1 → 1.6 mm, 40 s more".
    pub sentence: String,
    /// σ at the far end of the track (m), before (`None` if a direction was unobservable) and after the change.
    pub before_m: Option<f64>,
    pub after_m: f64,
    /// Increase of the drive's duration (s); negative if it is shorter.
    pub more_s: f64,
    pub plan: Plan,
}

/// Kind of a change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImprovementKind {
    FigureEight,
    Loop,
    TurnOnTheSpot,
    Ramp,
    CloserPass,
    PrismHeight,
    StationMoved,
    LongerDrive,
}

impl ImprovementKind {
    pub fn name(self) -> &'static str {
        match self {
            Self::FigureEight => "figure-eight",
            Self::Loop => "loop",
            Self::TurnOnTheSpot => "turn-on-the-spot",
            Self::Ramp => "ramp",
            Self::CloserPass => "closer-pass",
            Self::PrismHeight => "prism-height",
            Self::StationMoved => "station-moved",
            Self::LongerDrive => "longer-drive",
        }
    }
}

/// A candidate change.
struct Candidate {
    kind: ImprovementKind,
    what: String,
    plan: Plan,
}

/// Returns changes that reduce the error at the far end of the plan's own track, the smallest error first. Candidates that are
/// not yet tried when `progress` is cancelled are left out.
pub fn improvements(plan: &Plan, progress: &Progress) -> Result<Vec<Improvement>, PlanError> {
    let before = look(plan)?;
    let places_m = places_m(plan, &before);
    let before_m = far_end_m(plan, &before, &places_m);
    let before_s = before.driven.simulated.scenario.duration_s;
    let one = |candidate: Candidate| {
        progress.check().ok()?;
        // Invalid plans and plans out of reach are omitted.
        let after = look(&candidate.plan).ok()?;
        let after_m = far_end_m(&candidate.plan, &after, &places_m)?;
        let gains = before_m.is_none_or(|before_m| after_m < before_m * (1.0 - LEAST_GAIN));
        let more_s = after.driven.simulated.scenario.duration_s - before_s;
        gains.then(|| Improvement {
            sentence: sentence(&candidate.what, before_m, after_m, more_s),
            kind: candidate.kind,
            before_m,
            after_m,
            more_s,
            plan: candidate.plan,
        })
    };
    let all = candidates(plan);
    let mut found: Vec<Improvement> = all.into_par_iter().filter_map(one).collect();
    found.sort_by(|a, b| a.after_m.total_cmp(&b.after_m));
    Ok(found)
}

fn sentence(what: &str, before_m: Option<f64>, after_m: f64, more_s: f64) -> String {
    let before =
        before_m.map_or("not determined".to_owned(), |before_m| format!("{:.1}", before_m * 1e3));
    let costs = match more_s.round() {
        0.0 => "same duration".to_owned(),
        more_s if more_s < 0.0 => format!("{:.0} s less", -more_s),
        more_s => format!("{more_s:.0} s more"),
    };
    format!("{what}: {before} → {:.1} mm, {costs}", after_m * 1e3)
}

/// Positions of the stations' prisms along the path (m, frame of the plan).
fn places_m(plan: &Plan, looked: &Looked) -> PerStation<Vec<Vector3<f64>>> {
    let triplets = &looked.driven.pipeline.triplets;
    let transforms = &looked.driven.simulated.truth.station1_from_station;
    let step = (triplets.len() / MOST_PLACES).max(1);
    triplets.points_m.map_each(|station, points_m| {
        let own = points_m.iter().step_by(step);
        own.map(|p| transforms[station.index()].apply(p) + plan.stations_m[0]).collect()
    })
}

/// Returns the largest predicted σ over some positions (m); `None` if a direction is unobservable.
fn far_end_m(
    plan: &Plan,
    looked: &Looked,
    places_m: &PerStation<Vec<Vector3<f64>>>,
) -> Option<f64> {
    let transforms = looked
        .driven
        .simulated
        .truth
        .station1_from_station
        .map(|level| RigidTransform::from(*level));
    let own = places_m.map_each(|station, places_m| {
        let station_from_station1 = transforms[station.index()].inverse();
        places_m.iter().map(|p| station_from_station1.apply(&(p - plan.stations_m[0]))).collect()
    });
    let covariance = &looked.held()?.covariance;
    let covariance =
        DMatrix::from_column_slice(covariance.nrows(), covariance.ncols(), covariance.as_slice());
    Some(far_end(&transforms, &covariance, &own)?.sigma_m)
}

fn candidates(plan: &Plan) -> Vec<Candidate> {
    let mut all = Vec::new();
    all.extend(at_the_far_end(plan));
    let mut add = |kind, what: String, plan: Plan| all.push(Candidate { kind, what, plan });
    let (far_m, _) = far_place(plan);
    let ramp_m = along_the_middle(plan);
    let mut ramped = plan.clone();
    ramped.ground.ramps.push(Ramp { centre_m: ramp_m.into(), ..RAMP });
    let what = format!(
        "a ramp or bank {:.1} m high on the path, at x {:.0} m, y {:.0} m",
        RAMP.height_m, ramp_m.x, ramp_m.y
    );
    add(ImprovementKind::Ramp, what, ramped);
    let stations = plan.stations_m.iter().map(Vector3::xy);
    let middle_m = stations.sum::<Vector2<f64>>() / plan.stations_m.len() as f64;
    if let Some((end_m, _)) = plan.end() {
        let away = (end_m - middle_m).try_normalize(1e-6).unwrap_or_else(Vector2::x);
        let near = Waypoint::at(middle_m + away * NEAR_M);
        let mut closer = plan.clone();
        closer.way.push(Piece::Waypoints(vec![near, Waypoint::at(end_m)]));
        let what = format!("a pass {NEAR_M:.0} m from the stations, and back");
        add(ImprovementKind::CloserPass, what, closer);
    }
    if !plan.rig.is_one_prism() {
        for (prism, prism_m) in plan.rig.followed(plan.stations_m.len()).1.each() {
            for (by_m, way) in [(MAST_M, "higher"), (-MAST_M, "lower")] {
                if prism_m.z + by_m < LOWEST_PRISM_M {
                    continue;
                }
                let mut other = plan.clone();
                let same = other.rig.prisms_m.iter_mut().filter(|other_m| *other_m == prism_m);
                same.for_each(|other_m| other_m.z += by_m);
                let what = format!("prism {prism} {MAST_M:.1} m {way} on the vehicle");
                add(ImprovementKind::PrismHeight, what, other);
            }
        }
    }
    for station in 0..plan.stations_m.len() {
        for direction in 0..DIRECTIONS {
            // Directions along the sight to the far end and across it.
            let turn = Rotation2::new(f64::from(direction) * FRAC_PI_2);
            let own_m = plan.stations_m[station].xy();
            let sight = (far_m - own_m).try_normalize(1e-6).unwrap_or_else(Vector2::x);
            let moved_m = own_m + turn * sight * STEP_M;
            let mut other = plan.clone();
            other.stations_m[station].x = moved_m.x;
            other.stations_m[station].y = moved_m.y;
            let what = format!(
                "station {} moved by {STEP_M:.0} m, to x {:.1} m, y {:.1} m",
                station + 1,
                moved_m.x,
                moved_m.y
            );
            add(ImprovementKind::StationMoved, what, other);
        }
    }
    let mut twice = plan.clone();
    twice.way.extend(plan.way.iter().cloned());
    add(ImprovementKind::LongerDrive, "the same path once more".to_owned(), twice);
    all
}

/// Returns manoeuvres at the far end. A recorded path through a narrow place leaves only those that fit there.
fn at_the_far_end(plan: &Plan) -> Vec<Candidate> {
    let (far_m, along) = far_place(plan);
    let mut all = Vec::new();
    let mut add = |kind, what: String, piece: Piece| all.push((kind, what, piece));
    for length_m in EIGHTS_M {
        let eight = FigureEight::from_here(&far_m, &along, length_m);
        let what = format!("a figure-eight of {length_m:.0} m at the far end");
        add(ImprovementKind::FigureEight, what, Piece::FigureEight(eight));
    }
    for side in [1.0, -1.0] {
        let one = Piece::Loop(Loop::from_here(&far_m, &along, LOOP_RADIUS_M, side));
        let hand = if side > 0.0 { "left" } else { "right" };
        let what = format!("a loop to the {hand} of {:.0} m at the far end", 2.0 * LOOP_RADIUS_M);
        add(ImprovementKind::Loop, what, one);
    }
    let once_m = once_around_m(far_m, along).map(Waypoint::at);
    let what = "a turn once around on the spot at the far end".to_owned();
    add(ImprovementKind::TurnOnTheSpot, what, Piece::Waypoints(once_m.to_vec()));
    let driven_m: Vec<Vector2<f64>> = plan.waypoints().iter().map(Waypoint::place_m).collect();
    let corridor = if plan.is_driven { Corridor::shown(&driven_m, &far_m) } else { None };
    let fits = |piece: &Piece| {
        let way_m: Vec<Vector2<f64>> = piece.waypoints().iter().map(Waypoint::place_m).collect();
        corridor.as_ref().is_none_or(|corridor| corridor.fits(&way_m))
    };
    let fitting = all.into_iter().filter(|(_, _, piece)| fits(piece));
    fitting
        .map(|(kind, what, piece)| Candidate { kind, what, plan: with(plan, &far_m, piece) })
        .collect()
}

/// Returns the waypoint furthest from the stations and the direction of travel there.
fn far_place(plan: &Plan) -> (Vector2<f64>, Vector2<f64>) {
    let waypoints = plan.waypoints();
    let away_m = |place_m: Vector2<f64>| {
        let from = plan.stations_m.iter().map(|station_m| (place_m - station_m.xy()).norm());
        from.fold(0.0, f64::max)
    };
    let furthest = (0..waypoints.len())
        .max_by(|a, b| away_m(waypoints[*a].place_m()).total_cmp(&away_m(waypoints[*b].place_m())))
        .unwrap_or(0);
    let place_m = waypoints[furthest].place_m();
    let before = waypoints[..furthest].iter().rev().map(|at| place_m - at.place_m());
    let after = waypoints[furthest..].iter().map(|at| at.place_m() - place_m);
    let along = before.chain(after).find(|leg_m| leg_m.norm() > 0.1).unwrap_or_else(Vector2::x);
    (place_m, along.normalize())
}

/// Returns the position halfway along the path.
fn along_the_middle(plan: &Plan) -> Vector2<f64> {
    let waypoints = plan.waypoints();
    let mut left_m = super::way::length_m(&waypoints) / 2.0;
    for pair in waypoints.windows(2) {
        let leg_m = pair[1].place_m() - pair[0].place_m();
        if leg_m.norm() >= left_m {
            return pair[0].place_m() + leg_m * (left_m / leg_m.norm().max(1e-9));
        }
        left_m -= leg_m.norm();
    }
    waypoints.last().map_or_else(Vector2::zeros, Waypoint::place_m)
}

/// Returns the plan with a segment inserted where the path is nearest to a position.
fn with(plan: &Plan, place_m: &Vector2<f64>, piece: Piece) -> Plan {
    let away_m = |at: &Waypoint| (at.place_m() - place_m).norm();
    let mut nearest = (f64::INFINITY, 0, 0);
    for (index, own) in plan.way.iter().enumerate() {
        for (within, at) in own.waypoints().iter().enumerate() {
            if away_m(at) < nearest.0 {
                nearest = (away_m(at), index, within);
            }
        }
    }
    let (_, index, within) = nearest;
    let mut with = plan.clone();
    let rest = match &mut with.way[index] {
        Piece::Waypoints(waypoints) => waypoints.split_off(within + 1),
        Piece::FigureEight(_) | Piece::Loop(_) => Vec::new(),
    };
    with.way.insert(index + 1, piece);
    if !rest.is_empty() {
        with.way.insert(index + 2, Piece::Waypoints(rest));
    }
    with
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_prism_is_put_below_the_ground() {
        let mut plan = Plan::from_preset(crate::simulation::Preset::Warthog, 1);
        let lower = |plan: &Plan| {
            candidates(plan).iter().filter(|candidate| candidate.what.contains("lower")).count()
        };
        assert_eq!(lower(&plan), 3);
        // The prisms of a recorded drive lie about its origin.
        plan.rig.prisms_m.iter_mut().for_each(|prism_m| prism_m.z -= 1.4);
        assert_eq!(lower(&plan), 0);
    }
}
