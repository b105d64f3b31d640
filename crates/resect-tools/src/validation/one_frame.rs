//! Placement of another run in the frame of this run's station 1.
//!
//! Runs of one set-up share the frame of station 1, and [`super::validate()`] tests whether they do. If stations were set up
//! anew, the frames are aligned on control points that both runs read, provided that these points agree.

use nalgebra::Vector3;

use super::earlier::Earlier;
use super::in_words::Tell;
use super::outcome::Outcome;
use super::validate::{Validation, validate};
use resect_core::analysis::{Analysis, Answer};
use resect_core::deployment::Deployment;
use resect_core::evaluation::site::seen_m;
use resect_core::geometry::{LevelTransform, RigidTransform, align_level};
use resect_core::network::PerStation;

/// Smallest number of common control points for an alignment with a check that they are the same points.
const FEWEST_POINTS: usize = 3;
/// Largest residual of common points that are the same (m, root mean square of a coordinate).
const ALIKE_M: f64 = 0.010;
/// Smallest horizontal spread of the points about their mean that determines the heading (m, root of the sum of squares).
const NARROWEST_M: f64 = 1.0;

/// Pose of another run's station 1 in this run's frame, and its source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    pub station1_from_other: LevelTransform,
    pub by: PlacedBy,
}

/// Source of the alignment of two runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlacedBy {
    /// The set-up is the same: no station moved in between.
    SetUp,
    /// Number of common control points, and their residual (m, root mean square of a coordinate).
    ControlPoints { points: usize, rms_m: f64 },
}

/// Reason for which a run cannot be placed in the frame of another.
#[derive(Clone, Debug)]
pub enum NotPlaced {
    /// The run has no calibration, or no path.
    Itself(String),
    /// The stations were set up anew, and the control points do not align the runs.
    SetUpAnew { validation: Box<Validation>, points: String },
}

impl NotPlaced {
    /// Returns the reason as one sentence.
    pub fn in_words(&self, tell: &Tell<'_>) -> String {
        match self {
            Self::Itself(why) => why.clone(),
            Self::SetUpAnew { validation, points } => {
                format!("{}; {points}", validation.in_words(tell))
            }
        }
    }
}

/// Places another run in the frame of a run with a calibration.
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
    (deployment, own): (&Deployment, &PerStation<RigidTransform>),
    (other, theirs): (&Deployment, &PerStation<RigidTransform>),
) -> Result<Placed, String> {
    let mut pairs: Vec<(Vector3<f64>, Vector3<f64>)> = Vec::new();
    for set in &deployment.control_points {
        // Marker numbers identify points only within their file.
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
        return Err(format!("{count} common control points, {FEWEST_POINTS} needed"));
    }
    let (own_m, theirs_m): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
    let middle_m = own_m.iter().sum::<Vector3<f64>>() / count as f64;
    let spread_m2: f64 = own_m.iter().map(|p| (p - middle_m).xy().norm_squared()).sum();
    let found = align_level(&own_m, &theirs_m).filter(|_| spread_m2 > NARROWEST_M * NARROWEST_M);
    let Some(station1_from_other) = found else {
        return Err("the common control points lie in one place".to_owned());
    };
    let left = own_m.iter().zip(&theirs_m);
    let square: f64 =
        left.map(|(own, other)| (station1_from_other.apply(other) - own).norm_squared()).sum();
    let rms_m = (square / (3 * count) as f64).sqrt();
    if rms_m > ALIKE_M {
        return Err(format!("the common control points differ by {:.0} mm rms", 1e3 * rms_m));
    }
    Ok(Placed { station1_from_other, by: PlacedBy::ControlPoints { points: count, rms_m } })
}
