//! The vehicle of a drive in progress: its position, candidate manoeuvres from there, and their simulated readings.

use std::f64::consts::FRAC_PI_4;
use std::sync::Arc;

use nalgebra::{Rotation2, Vector2, Vector3};

use super::corridor::Corridor;
use super::drive::drive_with;
use super::manoeuvres::{
    ASIDE_M, EIGHTS_M, FigureEight, LOOP_RADIUS_M, Loop, NEAR_M, once_around_m, slalom_m,
};
use super::past::{AsDriven, middle_m};
use super::plan::{Plan, PlannedInstrument, PlannedRig};
use super::so_far::SoFar;
use super::way::Piece;
use crate::simulation::{Ground, Waypoint};
use resect_core::network::{PerStation, Prism};
use resect_core::pipeline::{FilteredTrack, Triplets};

/// Radius of half loops, which turn back (m); smaller than that of loops.
const HALF_RADIUS_M: f64 = 4.0;
/// Lengths of straight legs and slaloms (m).
const LEGS_M: [f64; 2] = [12.0, 25.0];
/// Directions in steps of 45°, counter-clockwise.
const WHERE_TO: [&str; 8] = [
    "ahead",
    "45° to the left",
    "to the left",
    "back to the left",
    "back",
    "back to the right",
    "to the right",
    "45° to the right",
];
/// Upper limit of the vehicle's slope (rad, root mean square). Errors of an early calibration look like slopes and are
/// unbounded.
const STEEPEST_RAD: f64 = 0.15;
/// Smallest cosine between the vehicle's heading and a leg; below it the vehicle turns on the spot.
const ON_THE_SPOT: f64 = 0.5;
/// Shortest distance to a destination (m).
const NEXT_DOOR_M: f64 = 6.0;
/// Distance between positions that determines a direction (m).
const HEADING_M: f64 = 0.5;
/// Pause between the readings so far and those of a manoeuvre (s).
const PAUSE_S: f64 = 1.0;
/// Smallest swerve of a slalom in a narrow place, to each side (m).
const LEAST_ASIDE_M: f64 = 0.4;
/// Smallest radius of bends in a narrow place (m); the vehicle turns on the spot instead.
const LEAST_RADIUS_M: f64 = 2.0;
/// Largest number of stored positions of the drive so far.
const MOST_PLACES: usize = 300;

/// A manoeuvre: its instruction, and its path in the frame of station 1 (m).
type Manoeuvre = (String, Vec<Vector2<f64>>);

/// Current state of the vehicle.
pub struct Here {
    place_m: Vector2<f64>,
    along: Vector2<f64>,
    /// Positions so far, thinned.
    driven_m: Vec<Vector2<f64>>,
    /// Room beside the vehicle; `None` if the drive shows no narrow place.
    corridor: Option<Corridor>,
    as_driven: AsDriven,
    ground_m: f64,
}

impl Here {
    pub fn of(so_far: &SoFar<'_>) -> Option<Self> {
        let triplets = so_far.triplets;
        let placed = |index: usize| -> PerStation<Vector3<f64>> {
            let transforms = so_far.station1_from_station;
            triplets
                .points_m
                .zip(transforms, |points_m, transform| transform.apply(&points_m[index]))
        };
        let all_m: Vec<PerStation<Vector3<f64>>> = (0..triplets.len()).map(placed).collect();
        let last_m = middle_m(all_m.last()?);
        let before = all_m.iter().rev().map(|at| (last_m - middle_m(at)).xy());
        let along = before.into_iter().find(|gone_m| gone_m.norm() > HEADING_M)?.normalize();
        let as_driven = if Prism::is_one(so_far.followed) {
            AsDriven { prisms_m: so_far.followed.map(|_| Vector3::zeros()), slope_rms_rad: 0.0 }
        } else {
            let prisms_m = so_far.followed.map(|prism| so_far.prisms_m[*prism]);
            AsDriven::of(&prisms_m, &triplets.time_s, &all_m)?
        };
        let step = (all_m.len() / MOST_PLACES).max(1);
        let driven_m = all_m.iter().step_by(step).map(|at| middle_m(at).xy()).collect();
        // The vehicle will work at the places of interest, so they are room as well.
        let middles_m = all_m.iter().map(|at| middle_m(at).xy());
        let shown_m: Vec<Vector2<f64>> =
            middles_m.chain(so_far.places_m.iter().map(Vector3::xy)).collect();
        let place_m = last_m.xy();
        let corridor = Corridor::shown(&shown_m, &place_m);
        Some(Self { place_m, along, driven_m, corridor, as_driven, ground_m: last_m.z })
    }

    /// Returns manoeuvres from here that fit the place, as far as the drive shows it.
    pub fn candidates(&self, so_far: &SoFar<'_>) -> Vec<Manoeuvre> {
        let mut all = self.bends();
        let around_m = once_around_m(self.place_m, self.along).into_iter();
        let once_here = std::iter::once(self.place_m).chain(around_m);
        all.push(("turn once around on the spot".to_owned(), once_here.collect()));
        for (eighth, way) in (0..).zip(WHERE_TO) {
            let along = self.turned(f64::from(eighth) * FRAC_PI_4);
            // An instruction "ahead" in a tunnel means along the tunnel.
            let along = self.corridor.as_ref().map_or(along, |place| place.aligned(&along));
            for leg_m in LEGS_M {
                self.add_legs(
                    &mut all,
                    self.place_m + along * leg_m,
                    &format!("{way} for {leg_m:.0} m"),
                );
            }
        }
        let stations = so_far.station1_from_station.map(|at| at.translation_m.xy());
        let middle_m = stations.iter().sum::<Vector2<f64>>() / stations.len() as f64;
        let away_m = self.place_m - middle_m;
        if away_m.norm() > NEAR_M + LEGS_M[1] / 2.0 {
            let near_m = middle_m + away_m.normalize() * NEAR_M;
            self.add_legs(&mut all, near_m, &format!("to {NEAR_M:.0} m from the stations"));
        }
        let least = self.least_visited_m(so_far).map(|far_m| (far_m, "not visited yet"));
        for (far_m, what) in least.into_iter().chain(ends_m(so_far, middle_m)) {
            if (far_m - self.place_m).norm() > NEXT_DOOR_M {
                self.add_legs(
                    &mut all,
                    far_m,
                    &format!("to ({:.0}, {:.0}), {what}", far_m.x, far_m.y),
                );
            }
        }
        if let Some(corridor) = &self.corridor {
            all.retain(|(_, way_m)| corridor.fits(way_m));
        }
        all
    }

    /// Returns figure-eights and loops; in a narrow place, only the largest that have room.
    fn bends(&self) -> Vec<Manoeuvre> {
        let mut all = Vec::new();
        // Rounded down to half metres, so that the instruction has few digits.
        let fitted_m = |room_m: f64| Some((2.0 * room_m).floor() / 2.0);
        let sides_m = self.corridor.as_ref().map(|place| place.sides_m(&self.along));
        let eights_m = match sides_m {
            None => EIGHTS_M.to_vec(),
            Some([right_m, left_m]) => fitted_m(2.0 * right_m.min(left_m)).into_iter().collect(),
        };
        for length_m in eights_m.into_iter().filter(|length_m| *length_m >= 4.0 * LEAST_RADIUS_M) {
            let length_m = length_m.min(EIGHTS_M[1]);
            let eight = FigureEight::from_here(&self.place_m, &self.along, length_m);
            all.push((format!("drive a figure-eight of {length_m} m here"), eight.places_m()));
        }
        for (side, hand) in [(1.0, "left"), (-1.0, "right")] {
            let room_m = sides_m.map(|[right_m, left_m]| if side > 0.0 { left_m } else { right_m });
            for (name, radius_m, turns) in
                [("loop", LOOP_RADIUS_M, 1.0), ("half loop", HALF_RADIUS_M, 0.5)]
            {
                let fitted_m =
                    room_m.and_then(fitted_m).map_or(radius_m, |m| radius_m.min(m / 2.0));
                if fitted_m < LEAST_RADIUS_M {
                    continue;
                }
                let one = Loop::from_here(&self.place_m, &self.along, fitted_m, side * turns);
                let what = format!("drive a {name} of {} m to the {hand}", 2.0 * fitted_m);
                all.push((what, one.places_m()));
            }
        }
        all
    }

    /// Adds the ways to drive to a place: straight, with a turn on the spot there, and as a slalom.
    fn add_legs(&self, all: &mut Vec<Manoeuvre>, to_m: Vector2<f64>, where_to: &str) {
        let along = (to_m - self.place_m).normalize();
        // Such a turn is too sharp for a bend; the vehicle turns on the spot.
        let first = if along.dot(&self.along) < ON_THE_SPOT { "turn on the spot, " } else { "" };
        let straight_m = vec![self.place_m, to_m];
        let turned_m = straight_m.iter().copied().chain(once_around_m(to_m, along)).collect();
        let straight = format!("{first}drive straight {where_to}");
        all.push((format!("{straight} and turn once around there"), turned_m));
        all.push((straight, straight_m));
        let room_m = self.corridor.as_ref().map_or(ASIDE_M, |place| {
            let [right_m, left_m] = place.sides_m(&along);
            right_m.min(left_m)
        });
        let aside_m = room_m.min(ASIDE_M);
        if aside_m >= LEAST_ASIDE_M {
            let size = if aside_m < ASIDE_M {
                format!(", {aside_m:.1} m to each side,")
            } else {
                String::new()
            };
            let slalom_m = slalom_m([self.place_m, to_m], aside_m, &self.along);
            all.push((format!("{first}drive a slalom{size} {where_to}"), slalom_m));
        }
    }

    /// Returns the place of interest that is furthest from the path so far.
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

    /// Simulates a manoeuvre and returns its triplets appended to those so far, and its duration (s).
    pub fn driven(&self, so_far: &SoFar<'_>, way_m: &[Vector2<f64>]) -> Option<(Triplets, f64)> {
        let yaws_rad: Vec<f64> =
            so_far.station1_from_station.iter().skip(1).map(|own| own.yaw_rad).collect();
        let prisms_m = self.as_driven.prisms_m.iter().copied().collect();
        let rig = PlannedRig { prisms_m, ..PlannedRig::default() };
        let plan = Plan {
            speed_m_per_s: so_far.speed_m_per_s,
            turn_radius_m: so_far.turn_radius_m,
            stations_m: so_far.station1_from_station.map(|own| own.translation_m),
            ground: Ground {
                height_m: self.ground_m,
                slope_rms_rad: self.as_driven.slope_rms_rad.min(STEEPEST_RAD),
                ..Ground::default()
            },
            rig,
            instrument: PlannedInstrument {
                rate_hz: so_far.rate_hz,
                ..PlannedInstrument::default()
            },
            thresholds: so_far.thresholds,
            // The path begins in the vehicle's current heading.
            way: vec![Piece::Waypoints(
                std::iter::once(self.place_m - self.along * HEADING_M)
                    .chain(way_m.iter().copied())
                    .map(Waypoint::at)
                    .collect(),
            )],
            ..Plan::default()
        };
        let driven = drive_with(&plan, &yaws_rad).ok()?;
        let takes_s = driven.simulated.scenario.duration_s;
        Some((joined(so_far.triplets, &driven.pipeline.triplets), takes_s))
    }
}

/// Appends the triplets of a drive that begins at the end of the others, after a pause.
fn joined(so_far: &Triplets, next: &Triplets) -> Triplets {
    let begins_s = next.time_s.first().copied().unwrap_or_default();
    let later_s = so_far.time_s.last().map_or(0.0, |last_s| last_s + PAUSE_S - begins_s);
    let intervals = so_far.interval.last().map_or(0, |last| last + 1);
    let times_s = |all: &[f64]| all.iter().map(|t| t + later_s).collect::<Vec<_>>();
    let track = |own: &FilteredTrack, more: &FilteredTrack| {
        // Readings of one station in a gap of the others may be later than the start of the manoeuvre; they add no
        // information.
        let before = own.time_s.partition_point(|t| *t < begins_s + later_s);
        FilteredTrack {
            time_s: [own.time_s[..before].to_vec(), times_s(&more.time_s)].concat(),
            position_m: [&own.position_m[..before], &more.position_m].concat(),
            ..FilteredTrack::default()
        }
    };
    let points_m = so_far.points_m.zip(&next.points_m, |own, more| [&own[..], more].concat());
    let interval = next.interval.iter().map(|interval| interval + intervals);
    let mut both = Triplets::new(
        [so_far.time_s.clone(), times_s(&next.time_s)].concat(),
        so_far.interval.iter().copied().chain(interval).collect(),
        points_m,
    );
    both.restarts_s.clone_from(&so_far.restarts_s);
    both.readings = Arc::new(so_far.readings.zip(&next.readings, track));
    // Predictions before and after a manoeuvre take the same readings.
    both.of_all_readings = so_far.of_all_readings.as_deref().map(|all| {
        let more = next.of_all_readings.as_deref().unwrap_or(next);
        Arc::new(joined(all, more))
    });
    both
}

/// Returns the extreme places of interest as seen from the stations: far, left, right and near.
fn ends_m(so_far: &SoFar<'_>, middle_m: Vector2<f64>) -> Vec<(Vector2<f64>, &'static str)> {
    let places_m: Vec<Vector2<f64>> = so_far.places_m.iter().map(Vector3::xy).collect();
    let mean_m = places_m.iter().sum::<Vector2<f64>>() / places_m.len().max(1) as f64;
    let Some(out) = (mean_m - middle_m).try_normalize(1e-6) else { return Vec::new() };
    let left = Vector2::new(-out.y, out.x);
    let ends = [
        (out, "the far end"),
        (left, "the left end"),
        (-left, "the right end"),
        (-out, "the near end"),
    ];
    let end_m = |(towards, what): (Vector2<f64>, &'static str)| {
        let furthest = places_m.iter().max_by(|a, b| a.dot(&towards).total_cmp(&b.dot(&towards)));
        Some((*furthest?, what))
    };
    ends.into_iter().filter_map(end_m).collect()
}
