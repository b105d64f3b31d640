//! Observability of a drive: the spectrum of JᵀJ, direction by direction, in words.
//!
//! Directions are in centred parameters with yaw in metres at the track's radius, so that each component is a displacement of the
//! track's points. Jointly unobservable directions (three of eight on a straight line) span a space without a preferred basis. The
//! simplest motions in that space are reported: one station sliding, or all swinging as if the rig had another orientation.

use nalgebra::{Vector2, Vector3};

use super::drive_shape::{DriveShape, PlanView};
use super::motion_in_words::{
    MotionComponent, PoseDirection, TrackAxes, describe, leading_part, stations_in_words,
};
use super::prism_network::{UNKNOWNS_PER_STATION, first_unknown};
use super::uncertainty::{FREE_DIRECTION, Uncertainty};
use super::{CentredTriplets, Parameters};
use crate::calibration::checks::{FREE_SIGMA_M, WEAK_SIGMA_M};
use crate::network::{PerStation, Station};

/// Eigenvalue over the largest below which a direction is weak. An error outside σ, such as a bias of the distances, has ten
/// times the effect there as in the best direction. Measured: drives such as an L reach 5e-3, drives with bends 2e-2.
const WEAK_DIRECTION: f64 = 1e-2;
/// Share of a simple motion's length that must be in the unobservable space.
const INSIDE: f64 = 0.95;
/// Share of a simple motion that must be independent of those already chosen.
const NEW: f64 = 0.3;

/// Observability of an answer.
#[derive(Clone, Debug)]
pub struct Observability {
    /// As many independent directions as unknowns, from the least observable to the best.
    pub directions: Vec<Direction>,
    pub drive: DriveShape,
    /// Advice on the next drive, to improve the least observable direction.
    pub advice: &'static str,
    /// Radius of the track: displacement by a radian of yaw (m).
    pub track_radius_m: f64,
}

/// One direction of a joint error of all stations but the first.
#[derive(Clone, Debug)]
pub struct Direction {
    /// Information along it over that along the best direction.
    pub relative: f64,
    /// Standard deviation of the answer along it (m); `None` if a direction is unobservable.
    pub sigma_m: Option<f64>,
    pub hold: Hold,
    pub words: String,
    /// Motion of each station along this direction; zero of station 1.
    pub motion: PerStation<StationMotion>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// Unobservable.
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

/// Motion of a station for one metre along a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StationMotion {
    /// Displacement of the instrument, in station 1's frame (m per m).
    pub translation_m: Vector3<f64>,
    /// Rotation of its zero direction (rad per m).
    pub yaw_rad: f64,
}

impl Direction {
    /// Returns the words up to the first comma that is not between numbers of stations.
    pub fn short(&self) -> &str {
        let mut commas = self.words.match_indices(", ");
        let is_end = |at: usize| !self.words[at + 2..].starts_with(|c: char| c.is_ascii_digit());
        commas.find(|(at, _)| is_end(*at)).map_or(&*self.words, |(at, _)| &self.words[..at])
    }
}

impl Observability {
    pub fn count(&self, hold: Hold) -> usize {
        self.directions.iter().filter(|direction| direction.hold == hold).count()
    }

    /// Returns the number of directions that the drive by itself determines weakly or not at all.
    pub fn open_to_drive(&self) -> usize {
        self.directions.iter().filter(|direction| direction.relative < WEAK_DIRECTION).count()
    }

    /// Returns the words of all directions with this `hold`, separated by semicolons.
    pub fn words(&self, hold: Hold) -> String {
        let words: Vec<&str> = (self.directions.iter())
            .filter(|direction| direction.hold == hold)
            .map(|direction| direction.words.as_str())
            .collect();
        words.join("; ")
    }
}

/// Computes the observability of an answer. `data` are inliers in order of time.
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
    let is_by_drive = !uncertainty.has_control_points;
    let advice = advice(&drive.plan, leading_part(&axes, &motions[0].motion));
    let swinging: Vec<usize> = data.network.unknown_stations().map(Station::number).collect();
    let swinging = stations_in_words(&swinging);
    let direction = |(rank, Named { motion, relative, free, swing }): (usize, Named)| {
        let covariance_m2 = uncertainty.centred_m2.as_ref();
        let sigma_m = covariance_m2
            .map(|covariance_m2| motion.dot(&(covariance_m2 * &motion)).max(0.0).sqrt());
        // A degenerate answer has an unobservable direction even if no eigenvalue shows it.
        let first = rank == 0;
        let hold = if is_by_drive && free || sigma_m > Some(FREE_SIGMA_M) || first && degenerate {
            Hold::Free
        } else if is_by_drive && relative < WEAK_DIRECTION || sigma_m > Some(WEAK_SIGMA_M) {
            Hold::Weak
        } else {
            Hold::Held
        };
        let words = swing.map_or_else(
            || describe(&axes, &motion, hold == Hold::Free),
            |swing| format!("{swinging} can rotate {swing}"),
        );
        let at_stations = at_the_stations(data, answer, &motion, uncertainty.radius_m);
        Direction { relative, sigma_m, hold, words, motion: at_stations }
    };
    let directions = motions.into_iter().enumerate().map(direction).collect();
    Observability { directions, drive, advice, track_radius_m: uncertainty.radius_m }
}

/// A motion of length one, before its description.
#[derive(Clone)]
struct Named {
    motion: PoseDirection,
    relative: f64,
    free: bool,
    /// Description of the rig's orientation, for a swing.
    swing: Option<&'static str>,
}

/// Returns the eigenvectors of JᵀJ, with the simplest motions in place of those that are jointly unobservable.
fn motions(axes: &TrackAxes, answer: &Parameters, uncertainty: &Uncertainty) -> Vec<Named> {
    let spectrum = &uncertainty.spectrum;
    let largest = spectrum.eigenvalues.max();
    let eigen = |k: usize| {
        let relative = (spectrum.eigenvalues[k] / largest).max(0.0);
        let motion = spectrum.eigenvectors.column(k).into_owned();
        Named { motion, relative, free: relative <= FREE_DIRECTION, swing: None }
    };
    let mut motions: Vec<Named> = (0..answer.len()).map(eigen).collect();
    let free: Vec<PoseDirection> =
        motions.iter().filter(|m| m.free).map(|m| m.motion.clone()).collect();
    if free.len() > 1 {
        let plain = plainest(&free, &candidates(axes, answer));
        for (named, (motion, swing)) in motions.iter_mut().filter(|m| m.free).zip(plain) {
            let resists: f64 = (0..answer.len())
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

/// Returns simple motions, the simplest first, with a description of each swing.
fn candidates(axes: &TrackAxes, answer: &Parameters) -> Vec<(PoseDirection, Option<&'static str>)> {
    let [ax, ay] = axes.along;
    let simple =
        [[ax, ay, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 0.0], [-ay, ax, 0.0, 0.0]];
    let mut candidates = Vec::new();
    for pose in simple {
        for first in (0..answer.len()).step_by(UNKNOWNS_PER_STATION) {
            let mut motion = PoseDirection::zeros(answer.len());
            motion.fixed_rows_mut::<UNKNOWNS_PER_STATION>(first).copy_from_slice(&pose);
            candidates.push((motion, None));
        }
    }
    // If the rig never rotates, its orientation on the vehicle is unobservable: all stations move about station 1's prism with it.
    for (axis, words) in [
        (Vector3::new(ax, ay, 0.0), "about the track, like a roll of the rig"),
        (Vector3::z(), "about the vertical, like a yaw of the rig"),
        (
            Vector3::new(-ay, ax, 0.0),
            "about the horizontal across the track, like a pitch of the rig",
        ),
    ] {
        let mut motion = PoseDirection::zeros(answer.len());
        for first in (0..answer.len()).step_by(UNKNOWNS_PER_STATION) {
            let from_prism_1_m = answer.fixed_rows::<3>(first).into_owned();
            motion.fixed_rows_mut::<3>(first).copy_from(&axis.cross(&from_prism_1_m));
        }
        candidates.extend(motion.try_normalize(1e-6).map(|motion| (motion, Some(words))));
    }
    candidates
}

/// Returns the simplest independent unobservable motions, as many as there are: candidates first, then the remaining directions.
fn plainest(
    free: &[PoseDirection],
    candidates: &[(PoseDirection, Option<&'static str>)],
) -> Vec<(PoseDirection, Option<&'static str>)> {
    let mut said: Vec<PoseDirection> = Vec::new();
    let mut chosen = Vec::new();
    let unsaid = |motion: &PoseDirection, said: &[PoseDirection]| {
        said.iter().fold(motion.clone(), |rest, one| rest - one * one.dot(motion))
    };
    for (candidate, swing) in candidates {
        let inside = (free.iter())
            .fold(PoseDirection::zeros(candidate.len()), |sum, one| sum + one * one.dot(candidate));
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

/// Converts a motion at the centroid of each station's track to one at the instrument, which a rotation about the centroid
/// displaces.
fn at_the_stations(
    data: &CentredTriplets,
    answer: &Parameters,
    motion: &PoseDirection,
    radius_m: f64,
) -> PerStation<StationMotion> {
    data.centre_m.map_each(|station, centre_m| {
        let Some(first) = first_unknown(station) else {
            return StationMotion { translation_m: Vector3::zeros(), yaw_rad: 0.0 };
        };
        let yaw_rad = motion[first + 3] / radius_m;
        let station_from_centroid = data.pose(answer, station).rotate(&-centre_m);
        let turned = Vector2::new(-station_from_centroid.y, station_from_centroid.x) * yaw_rad;
        let translation_m = motion.fixed_rows::<3>(first) + turned.push(0.0);
        StationMotion { translation_m, yaw_rad }
    })
}

/// Returns advice on the next drive.
fn advice(plan: &PlanView, weakest: MotionComponent) -> &'static str {
    match (plan, weakest) {
        (PlanView::Standing, _) => {
            "turn once around on the spot in several places, or drive a figure-eight as wide as the place allows"
        }
        (PlanView::StraightLine { .. }, _) => {
            "turn once around on the spot at both ends of the line"
        }
        (PlanView::Circle { .. }, _) => {
            "turn the other way too: turn once around on the spot, or drive a figure-eight if the place allows"
        }
        (PlanView::TwoLegs { .. }, _) => {
            "one corner is not enough: turn once around on the spot, or drive a figure-eight if the place allows"
        }
        (PlanView::Winding, MotionComponent::Height) => {
            "drive over a ramp or uneven ground, or mount the prisms at heights that differ more"
        }
        (PlanView::Winding, MotionComponent::Turn) => {
            "drive further from the middle of the track, if the place allows: a longer track determines yaw better"
        }
        (
            PlanView::Winding,
            MotionComponent::Along | MotionComponent::Across | MotionComponent::Level,
        ) => "turn more: turn once around on the spot, or drive a figure-eight if the place allows",
    }
}
