//! What the drive holds and what it does not: the spectrum of JᵀJ, direction by direction, in words.
//!
//! Directions live in centred parameters with yaw in metres at the track's radius, where every part of a motion is what
//! it moves the points of the track by. What is free together (a straight line leaves three of eight) has no directions
//! of its own; there the plainest motions that lie in it are taken: one station sliding, or both swinging as if the rig
//! stood differently.

use nalgebra::{Vector2, Vector3};

use super::drive_shape::{DriveShape, Plan};
use super::motion_in_words::{Motion, Part, TrackAxes, describe, leading_part};
use super::uncertainty::{FREE_DIRECTION, Uncertainty};
use super::{CentredTriplets, Parameters, gross_errors};
use crate::calibration::checks::{FREE_SIGMA_M, WEAK_SIGMA_M};
use crate::geometry::LevelTransform;

/// Eigenvalues below this share of the largest belong to drives such as an L (5e-3); drives with bends reach 2e-2. An
/// error that is in no σ, such as a bias of the distances, weighs ten times as much there as where the drive is best.
const WEAK_DIRECTION: f64 = 1e-2;
/// A plain motion stands for a part of the free ones when this much of its length lies among them.
const INSIDE: f64 = 0.95;
/// A plain motion is said only where this much of it is not said already.
const NEW: f64 = 0.3;

/// How the drive holds the answer.
#[derive(Clone, Debug)]
pub struct Observability {
    /// Eight independent directions, from the least held to the best.
    pub directions: [Direction; 8],
    pub drive: DriveShape,
    /// What to drive next, to hold the least held direction better.
    pub advice: &'static str,
    /// What a radian of yaw moves the track by (m).
    pub track_radius_m: f64,
}

/// One direction in which stations 2 and 3 may err together.
#[derive(Clone, Debug)]
pub struct Direction {
    /// How much the distances resist, over the direction in which they resist most.
    pub relative: f64,
    /// Standard deviation along it (m), of the answer; `None` where a direction is free.
    pub sigma_m: Option<f64>,
    pub hold: Hold,
    pub words: String,
    /// How stations 2 and 3 move along this direction.
    pub motion: [StationMotion; 2],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// Nothing resists a move in this direction.
    Free,
    Weak,
    Held,
}

impl Hold {
    pub fn name(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Weak => "weak",
            Self::Held => "held",
        }
    }
}

/// How a station moves when the answer moves one metre along a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StationMotion {
    /// How the instrument moves, in station 1's frame (m per m).
    pub translation_m: Vector3<f64>,
    /// How its zero direction turns (rad per m).
    pub yaw_rad: f64,
}

impl Direction {
    /// The words without what follows the first comma.
    pub fn short(&self) -> &str {
        self.words.split(',').next().unwrap_or_default()
    }
}

impl Observability {
    pub fn count(&self, hold: Hold) -> usize {
        self.directions.iter().filter(|direction| direction.hold == hold).count()
    }

    /// The words of all directions that are held like this.
    pub fn words(&self, hold: Hold) -> String {
        let words: Vec<&str> = (self.directions.iter())
            .filter(|direction| direction.hold == hold)
            .map(|direction| direction.words.as_str())
            .collect();
        words.join("; ")
    }
}

/// The triplets that are not wild.
pub fn fitting(data: &CentredTriplets, answer: &Parameters) -> CentredTriplets {
    let errors_m = data.distance_errors_m(answer);
    let pairs = errors_m.chunks(3).map(|pairs| [pairs[0], pairs[1], pairs[2]]);
    data.select(&gross_errors::fitting(pairs))
}

/// Reads the spectrum at an answer. `data` are triplets that fit, in order of time.
pub fn observe(
    data: &CentredTriplets,
    answer: &Parameters,
    uncertainty: &Uncertainty,
) -> Observability {
    let axes = TrackAxes::of(data);
    let drive = DriveShape::of(data);
    let mut motions = motions(&axes, answer, uncertainty);
    motions.sort_by(|a, b| a.relative.total_cmp(&b.relative));
    let degenerate = uncertainty.weakest_sigma_m > FREE_SIGMA_M;
    let mut rank = 0..8;
    let directions = motions.map(|Named { motion, relative, free, swing }| {
        let sigma_m = uncertainty
            .centred_m2
            .map(|covariance| motion.dot(&(covariance * motion)).max(0.0).sqrt());
        // What the verdict calls degenerate has a free direction, whatever the eigenvalues say.
        let first = rank.next() == Some(0);
        let hold = if free || sigma_m > Some(FREE_SIGMA_M) || first && degenerate {
            Hold::Free
        } else if relative < WEAK_DIRECTION || sigma_m > Some(WEAK_SIGMA_M) {
            Hold::Weak
        } else {
            Hold::Held
        };
        let words = swing.map_or_else(
            || describe(&axes, &motion, hold == Hold::Free),
            |swing| format!("stations 2 and 3 can swing {swing}"),
        );
        let at_stations = at_the_stations(data, answer, &motion, uncertainty.radius_m);
        Direction { relative, sigma_m, hold, words, motion: at_stations }
    });
    let advice = advice(&drive.plan, leading_part(&axes, &motions[0].motion));
    Observability { directions, drive, advice, track_radius_m: uncertainty.radius_m }
}

/// A motion of length one, before it is put into words.
#[derive(Clone, Copy)]
struct Named {
    motion: Motion,
    relative: f64,
    free: bool,
    /// How the rig would have to stand for it, where it is one of the swings.
    swing: Option<&'static str>,
}

/// The eigenvectors of JᵀJ; in place of those that are free together, the plainest motions among them.
fn motions(axes: &TrackAxes, answer: &Parameters, uncertainty: &Uncertainty) -> [Named; 8] {
    let spectrum = &uncertainty.spectrum;
    let largest = spectrum.eigenvalues.max();
    let eigen = |k: usize| {
        let relative = (spectrum.eigenvalues[k] / largest).max(0.0);
        let motion = spectrum.eigenvectors.column(k).into_owned();
        Named { motion, relative, free: relative <= FREE_DIRECTION, swing: None }
    };
    let mut motions: [Named; 8] = std::array::from_fn(eigen);
    let free: Vec<Motion> = motions.iter().filter(|m| m.free).map(|m| m.motion).collect();
    if free.len() > 1 {
        let plain = plainest(&free, &candidates(axes, answer));
        for (named, (motion, swing)) in motions.iter_mut().filter(|m| m.free).zip(plain) {
            let resists: f64 = (0..8)
                .map(|k| {
                    let part = spectrum.eigenvectors.column(k).dot(&motion);
                    spectrum.eigenvalues[k] * part * part
                })
                .sum();
            *named = Named { motion, relative: (resists / largest).max(0.0), free: true, swing };
        }
    }
    motions
}

/// Motions with a name, the plainest first.
fn candidates(axes: &TrackAxes, answer: &Parameters) -> Vec<(Motion, Option<&'static str>)> {
    let [ax, ay] = axes.along;
    let level = |at: usize, x: f64, y: f64| {
        let mut motion = Motion::zeros();
        (motion[at], motion[at + 1]) = (x, y);
        motion
    };
    let single = |at: usize| {
        let mut motion = Motion::zeros();
        motion[at] = 1.0;
        motion
    };
    let mut candidates: Vec<_> = [
        level(0, ax, ay),
        level(4, ax, ay),
        single(3),
        single(7),
        single(2),
        single(6),
        level(0, -ay, ax),
        level(4, -ay, ax),
    ]
    .map(|motion| (motion, None))
    .into();
    // While the rig never turns, nothing tells how it stands on the vehicle: both stations move about prism 1 with it.
    for (axis, words) in [
        (Vector3::new(ax, ay, 0.0), "about the track, as if the rig leaned to a side"),
        (Vector3::z(), "about the vertical, as if the rig faced elsewhere"),
        (Vector3::new(-ay, ax, 0.0), "up and along, as if the rig nodded"),
    ] {
        let mut motion = Motion::zeros();
        for at in [0, 4] {
            let from_prism_1_m = answer.fixed_rows::<3>(at).into_owned();
            motion.fixed_rows_mut::<3>(at).copy_from(&axis.cross(&from_prism_1_m));
        }
        candidates.extend(motion.try_normalize(1e-6).map(|motion| (motion, Some(words))));
    }
    candidates
}

/// The plainest free motions, independent and as many as there are: candidates first, then what they leave.
fn plainest(
    free: &[Motion],
    candidates: &[(Motion, Option<&'static str>)],
) -> Vec<(Motion, Option<&'static str>)> {
    let mut said: Vec<Motion> = Vec::new();
    let mut chosen = Vec::new();
    let unsaid = |motion: &Motion, said: &[Motion]| {
        said.iter().fold(*motion, |rest, one| rest - one * one.dot(motion))
    };
    for (candidate, swing) in candidates {
        let inside: Motion = free.iter().map(|one| one * one.dot(candidate)).sum();
        let rest = unsaid(&inside, &said);
        if chosen.len() < free.len() && inside.norm() > INSIDE && rest.norm() > NEW {
            said.push(rest.normalize());
            chosen.push((inside.normalize(), *swing));
        }
    }
    while chosen.len() < free.len() {
        let rests = free.iter().map(|one| unsaid(one, &said));
        let Some(most) = rests.max_by(|a, b| a.norm().total_cmp(&b.norm())) else { break };
        said.push(most.normalize());
        chosen.push((most.normalize(), None));
    }
    chosen
}

/// Moves a motion from the centroid of each station's track to its instrument: a turn about the centroid moves it
/// sideways.
fn at_the_stations(
    data: &CentredTriplets,
    answer: &Parameters,
    motion: &Motion,
    radius_m: f64,
) -> [StationMotion; 2] {
    [0, 1].map(|slot| {
        let yaw_rad = motion[4 * slot + 3] / radius_m;
        let station_from_centroid = LevelTransform::new(Vector3::zeros(), answer[4 * slot + 3])
            .rotate(&-data.centre_m[slot + 1]);
        let turned = Vector2::new(-station_from_centroid.y, station_from_centroid.x) * yaw_rad;
        let translation_m = motion.fixed_rows::<3>(4 * slot) + turned.push(0.0);
        StationMotion { translation_m, yaw_rad }
    })
}

/// What to drive next.
fn advice(plan: &Plan, weakest: Part) -> &'static str {
    match (plan, weakest) {
        (Plan::Standing, _) => {
            "drive: a figure-eight with turns to both sides, 20 m or more across"
        }
        (Plan::StraightLine { .. }, _) => {
            "leave the line: drive a figure-eight with turns to both sides"
        }
        (Plan::Circle { .. }, _) => {
            "turn the other way too: drive a figure-eight with turns to both sides"
        }
        (Plan::TwoLegs { .. }, _) => {
            "do not rest it on one corner: drive a figure-eight with turns to both sides"
        }
        (Plan::Winding, Part::Height) => {
            "drive over a ramp or uneven ground, or fix the prisms at heights that differ more"
        }
        (Plan::Winding, Part::Turn) => {
            "drive further: yaw is held by how far the track reaches from its middle"
        }
        (Plan::Winding, Part::Along | Part::Across | Part::Level) => {
            "turn more: drive a figure-eight with turns to both sides"
        }
    }
}
