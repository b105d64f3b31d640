//! Runs beside each other in one frame: where station 1 of another run stands in the frame of this one's.
//!
//! Runs of one set-up have one frame, station 1's, and [`super::validate`] says whether they are. Stations that were set up
//! anew are brought together by the control points that both runs read, where these lie alike.

use nalgebra::Vector3;

use super::earlier::Earlier;
use super::in_words::Tell;
use super::outcome::Outcome;
use super::validate::{Validation, validate};
use crate::analysis::{Analysis, Answer};
use crate::deployment::Deployment;
use crate::evaluation::site::seen_m;
use crate::geometry::{LevelTransform, RigidTransform, align_level};

/// So many common control points tell a frame, and whether they are the same points.
const FEWEST_POINTS: usize = 3;
/// Common points that lie alike to this (m, root mean square of a coordinate) are the same points.
const ALIKE_M: f64 = 0.010;
/// Points closer to their middle than this in plan leave the heading open (m, root of the sum of squares).
const NARROWEST_M: f64 = 1.0;

/// Where another run lies, and how that is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    pub station1_from_other: LevelTransform,
    pub by: PlacedBy,
}

/// What brings two runs together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlacedBy {
    /// No station moved in between.
    SetUp,
    /// So many control points of both, and what they leave (m, root mean square of a coordinate).
    ControlPoints { points: usize, rms_m: f64 },
}

/// Why a run cannot be placed beside another.
#[derive(Clone, Debug)]
pub enum NotPlaced {
    /// It has no answer, or no way.
    Itself(String),
    /// The stations were set up anew, and the control points do not bring the runs together.
    SetUpAnew { validation: Box<Validation>, points: String },
}

impl NotPlaced {
    /// One sentence.
    pub fn in_words(&self, tell: &Tell<'_>) -> String {
        match self {
            Self::Itself(why) => why.clone(),
            Self::SetUpAnew { validation, points } => {
                format!("{}; {points}", validation.in_words(tell))
            }
        }
    }
}

/// Places another run beside one that has an answer.
pub fn place(
    (deployment, answer): (&Deployment, &Answer),
    (other, analysis): (&Deployment, &Analysis),
) -> Result<Placed, NotPlaced> {
    let validation = validate(&Earlier::of(deployment, answer), other, analysis);
    if validation.outcome == Outcome::Holds {
        let by = PlacedBy::SetUp;
        return Ok(Placed { station1_from_other: LevelTransform::IDENTITY, by });
    }
    let other_answer =
        analysis.answer.as_ref().map_err(|error| NotPlaced::Itself(error.to_string()))?;
    let by_points = by_control_points(
        (deployment, &answer.calibration.station1_from_station),
        (other, &other_answer.calibration.station1_from_station),
    );
    let validation = Box::new(validation);
    by_points.map_err(|points| NotPlaced::SetUpAnew { validation, points })
}

fn by_control_points(
    (deployment, own): (&Deployment, &[RigidTransform; 3]),
    (other, theirs): (&Deployment, &[RigidTransform; 3]),
) -> Result<Placed, String> {
    let mut pairs: Vec<(Vector3<f64>, Vector3<f64>)> = Vec::new();
    for set in &deployment.control_points {
        // A number means something inside its file only.
        let Some(same) = other.control_points.iter().find(|other| other.file == set.file) else {
            continue;
        };
        pairs.extend(set.points.iter().filter_map(|point| {
            let beside = same.points.iter().find(|other| other.marker == point.marker)?;
            Some((seen_m(point, own)?, seen_m(beside, theirs)?))
        }));
    }
    let count = pairs.len();
    if count < FEWEST_POINTS {
        return Err(format!(
            "they have {count} control points in common, of {FEWEST_POINTS} that it takes"
        ));
    }
    let (own_m, theirs_m): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
    let middle_m = own_m.iter().sum::<Vector3<f64>>() / count as f64;
    let spread_m2: f64 = own_m.iter().map(|p| (p - middle_m).xy().norm_squared()).sum();
    let found = align_level(&own_m, &theirs_m).filter(|_| spread_m2 > NARROWEST_M * NARROWEST_M);
    let Some(station1_from_other) = found else {
        return Err("their common control points lie on top of each other".to_owned());
    };
    let left = own_m.iter().zip(&theirs_m);
    let square: f64 =
        left.map(|(own, other)| (station1_from_other.apply(other) - own).norm_squared()).sum();
    let rms_m = (square / (3 * count) as f64).sqrt();
    if rms_m > ALIKE_M {
        return Err(format!(
            "control points of the same names lie otherwise, by {:.0} mm rms",
            1e3 * rms_m
        ));
    }
    Ok(Placed { station1_from_other, by: PlacedBy::ControlPoints { points: count, rms_m } })
}
