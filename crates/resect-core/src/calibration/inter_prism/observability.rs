//! Observability of a drive: the spectrum of JᵀJ, direction by direction, in words.
//!
//! Directions are in centred parameters with yaw in metres at the track's radius, so that each component is a displacement of the
//! track's points. Jointly unobservable directions (three of eight on a straight line) span a space without a preferred basis. The
//! simplest motions in that space are reported: one station sliding, or both swinging as if the rig had another orientation.

use nalgebra::{Vector2, Vector3};

use super::drive_shape::{DriveShape, PlanView};
use super::motion_in_words::{MotionComponent, PoseDirection, TrackAxes, describe, leading_part};
use super::uncertainty::{FREE_DIRECTION, Uncertainty};
use super::{CentredTriplets, Parameters, gross_errors};
use crate::calibration::checks::{FREE_SIGMA_M, WEAK_SIGMA_M};
use crate::geometry::LevelTransform;

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
    /// Eight independent directions, from the least observable to the best.
    pub directions: [Direction; 8],
    pub drive: DriveShape,
    /// Advice on the next drive, to improve the least observable direction.
    pub advice: &'static str,
    /// Radius of the track: displacement by a radian of yaw (m).
    pub track_radius_m: f64,
}

/// One direction of a joint error of stations 2 and 3.
#[derive(Clone, Debug)]
pub struct Direction {
    /// Information along it over that along the best direction.
    pub relative: f64,
    /// Standard deviation of the answer along it (m); `None` if a direction is unobservable.
    pub sigma_m: Option<f64>,
    pub hold: Hold,
    pub words: String,
    /// Motion of stations 2 and 3 along this direction.
    pub motion: [StationMotion; 2],
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
    /// Returns the words up to the first comma.
    pub fn short(&self) -> &str {
        self.words.split(',').next().unwrap_or_default()
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

/// Returns the triplets that are not gross outliers.
pub fn fitting(data: &CentredTriplets, answer: &Parameters) -> CentredTriplets {
    let errors_m = data.distance_errors_m(answer);
    let pairs = errors_m.chunks(3).map(|pairs| [pairs[0], pairs[1], pairs[2]]);
    data.select(&gross_errors::fitting(pairs))
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
    let mut rank = 0..8;
    let directions = motions.map(|Named { motion, relative, free, swing }| {
        let sigma_m = uncertainty
            .centred_m2
            .map(|covariance| motion.dot(&(covariance * motion)).max(0.0).sqrt());
        // A degenerate answer has an unobservable direction even if no eigenvalue shows it.
        let first = rank.next() == Some(0);
        let hold = if is_by_drive && free || sigma_m > Some(FREE_SIGMA_M) || first && degenerate {
            Hold::Free
        } else if is_by_drive && relative < WEAK_DIRECTION || sigma_m > Some(WEAK_SIGMA_M) {
            Hold::Weak
        } else {
            Hold::Held
        };
        let words = swing.map_or_else(
            || describe(&axes, &motion, hold == Hold::Free),
            |swing| format!("stations 2 and 3 can rotate {swing}"),
        );
        let at_stations = at_the_stations(data, answer, &motion, uncertainty.radius_m);
        Direction { relative, sigma_m, hold, words, motion: at_stations }
    });
    let advice = advice(&drive.plan, leading_part(&axes, &motions[0].motion));
    Observability { directions, drive, advice, track_radius_m: uncertainty.radius_m }
}

/// A motion of length one, before its description.
#[derive(Clone, Copy)]
struct Named {
    motion: PoseDirection,
    relative: f64,
    free: bool,
    /// Description of the rig's orientation, for a swing.
    swing: Option<&'static str>,
}

/// Returns the eigenvectors of JᵀJ, with the simplest motions in place of those that are jointly unobservable.
fn motions(axes: &TrackAxes, answer: &Parameters, uncertainty: &Uncertainty) -> [Named; 8] {
    let spectrum = &uncertainty.spectrum;
    let largest = spectrum.eigenvalues.max();
    let eigen = |k: usize| {
        let relative = (spectrum.eigenvalues[k] / largest).max(0.0);
        let motion = spectrum.eigenvectors.column(k).into_owned();
        Named { motion, relative, free: relative <= FREE_DIRECTION, swing: None }
    };
    let mut motions: [Named; 8] = std::array::from_fn(eigen);
    let free: Vec<PoseDirection> = motions.iter().filter(|m| m.free).map(|m| m.motion).collect();
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

/// Returns simple motions, the simplest first, with a description of each swing.
fn candidates(axes: &TrackAxes, answer: &Parameters) -> Vec<(PoseDirection, Option<&'static str>)> {
    let [ax, ay] = axes.along;
    let level = |at: usize, x: f64, y: f64| {
        let mut motion = PoseDirection::zeros();
        (motion[at], motion[at + 1]) = (x, y);
        motion
    };
    let single = |at: usize| {
        let mut motion = PoseDirection::zeros();
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
    // If the rig never rotates, its orientation on the vehicle is unobservable: both stations move about prism 1 with it.
    for (axis, words) in [
        (Vector3::new(ax, ay, 0.0), "about the track, like a roll of the rig"),
        (Vector3::z(), "about the vertical, like a yaw of the rig"),
        (
            Vector3::new(-ay, ax, 0.0),
            "about the horizontal across the track, like a pitch of the rig",
        ),
    ] {
        let mut motion = PoseDirection::zeros();
        for at in [0, 4] {
            let from_prism_1_m = answer.fixed_rows::<3>(at).into_owned();
            motion.fixed_rows_mut::<3>(at).copy_from(&axis.cross(&from_prism_1_m));
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
        said.iter().fold(*motion, |rest, one| rest - one * one.dot(motion))
    };
    for (candidate, swing) in candidates {
        let inside: PoseDirection = free.iter().map(|one| one * one.dot(candidate)).sum();
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
