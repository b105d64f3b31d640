//! Search for the convention in which an estimate's orientations follow those of the ground truth.
//!
//! In the right convention the body is fixed in the vehicle: R_truthᵀ R_frame W op(q) is constant over the drive, for any body.
//! W is one of the 24 rotations of axes, and op the order of the quaternion's numbers and its inverse. A permutation of the
//! body's axes is a part of the constant. Each W has a twin: inverse and w first are together a rotation of axes of world and
//! body, so the more usual one of the two is reported.
//!
//! A single prism has no orientation. The lever arm to it turns as the body turns, and most bodies travel forward
//! ([`super::travel_direction`]).

use nalgebra::{Matrix4, Rotation3, UnitQuaternion, Vector3};

use super::block_comparison::{SIGNIFICANT, block_sums, students_t};
use super::lever_equations::{LeverNormal, LeverVector, position_rows, solve};
use super::travel_direction::{Travel, scatter_in_body_rad, travels};
use crate::estimates::conventions::{AngleConvention, Convention, Inverted, SignedAxes};
use crate::estimates::fit::Fit;
use crate::estimates::matched_pose::MatchedPose;
use resect_core::deployment::EstimatedPose;

/// Largest number of poses that are compared.
const MOST_POSES: usize = 400;
const FEWEST: usize = 30;
/// A convention is reported if its spread is this many times smaller than as read, and below this angle (rad): a few degrees of
/// drift are usual. An orientation that is wrong by chance is spread over tens of degrees.
const TIMES_BETTER: f64 = 4.0;
const LARGEST_SPREAD_RAD: f64 = 0.09;
/// Conventions whose spreads differ by less than this factor and this angle (rad) are not distinguished by the drive.
const SAME_SPREAD: f64 = 1.5;
const SAME_SPREAD_RAD: f64 = 2e-3;

/// A convention that fits the orientations better than as read.
#[derive(Clone, Debug, PartialEq)]
pub struct SuspectedOrientation {
    pub convention: Convention,
    /// Convention of a ground truth of poses that fits as well, or better: then that of the estimate is the stated one.
    pub of_truth: Option<Convention>,
    /// Other conventions that fit as well: the drive does not distinguish them.
    pub alternatives: Vec<Convention>,
    /// Root mean square over the drive, as read and in the convention: an angle (rad), or an error of positions (m).
    pub as_read: f64,
    pub with_convention: f64,
    pub evidence: OrientationEvidence,
}

/// The quantity by which conventions are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrientationEvidence {
    /// Angles from the orientations of the ground truth.
    Orientations,
    /// Errors of positions with a lever arm.
    LeverArm,
    /// Angles of the direction of travel in the body.
    Travel,
}

/// Returns the convention that fits much better than the stated one, with which the poses were read; `None` if there is none. The file of
/// a ground truth that is a trajectory may have the other one.
pub fn suspected_orientation(
    poses: &[EstimatedPose],
    pairs: &[MatchedPose],
    fit: &Fit,
    (stated, is_trajectory): (&Convention, bool),
) -> Option<SuspectedOrientation> {
    let step = pairs.len().div_ceil(MOST_POSES).max(1);
    let pairs: Option<Vec<WrittenOrientation<'_>>> = pairs
        .iter()
        .step_by(step)
        .map(|pair| {
            Some(WrittenOrientation { pair, written: stated.as_written(pair.pose.orientation?) })
        })
        .collect();
    let pairs =
        pairs.filter(|pairs| pairs.len() >= FEWEST && stated.inverted != Inverted::Poses)?;
    if pairs.iter().all(|each| each.pair.truth.rotation.is_some()) {
        let frame = &fit.truth_from_estimate.rotation;
        by_orientations(&pairs, frame, stated, is_trajectory)
    } else {
        by_lever_arm(&pairs, fit, stated)
            .or_else(|| by_travel(poses, stated))
            .or_else(|| by_first_orientation(poses, (&pairs, fit), stated))
    }
}

/// A pose with its ground truth, and the orientation as it stands in the file.
struct WrittenOrientation<'a> {
    pair: &'a MatchedPose,
    written: UnitQuaternion<f64>,
}

/// Operations on orientations: order of the numbers, inverse, and order or sense of angles.
type Operation = (bool, Inverted, AngleConvention);

/// Operations, the usual ones first.
const OPERATIONS: [Operation; 6] = [
    (false, Inverted::Nothing, AngleConvention::AsRead),
    (true, Inverted::Nothing, AngleConvention::AsRead),
    (false, Inverted::Orientations, AngleConvention::AsRead),
    (true, Inverted::Orientations, AngleConvention::AsRead),
    (false, Inverted::Nothing, AngleConvention::Xyz),
    (false, Inverted::Nothing, AngleConvention::Clockwise),
];

fn operation(convention: &Convention) -> Operation {
    (convention.has_w_first, convention.inverted, convention.angles)
}

/// Conventions of orientations, the usual ones first.
fn candidates(stated: &Convention) -> Vec<Convention> {
    let with = |world_axes| {
        OPERATIONS.map(|(has_w_first, inverted, angles)| Convention {
            has_w_first,
            inverted,
            angles,
            world_axes,
            ..*stated
        })
    };
    SignedAxes::rotations().into_iter().flat_map(with).collect()
}

fn by_orientations(
    pairs: &[WrittenOrientation<'_>],
    frame: &Rotation3<f64>,
    stated: &Convention,
    is_trajectory: bool,
) -> Option<SuspectedOrientation> {
    let frame = UnitQuaternion::from_rotation_matrix(frame);
    let spread_of_both_rad = |convention: &Convention, of_truth: &Convention| {
        let bodies = pairs.iter().filter_map(|each| {
            let truth = of_truth.orientation(each.pair.truth.rotation.as_ref()?.orientation);
            Some(truth.inverse() * frame * convention.orientation(each.written))
        });
        spread_rad(&bodies.collect::<Vec<_>>())
    };
    let spread_rad = |convention: &Convention| spread_of_both_rad(convention, &Convention::AS_READ);
    let scored: Vec<(Convention, f64)> = candidates(stated)
        .into_iter()
        .map(|candidate| (candidate, spread_rad(&candidate)))
        .collect();
    let as_read = spread_rad(stated);
    let limit_rad = LARGEST_SPREAD_RAD.min(as_read / TIMES_BETTER);
    let tie = SAME_SPREAD_RAD + (SAME_SPREAD - 1.0) * least(&scored);
    let of_estimate = suspected(&scored, (as_read, tie), OrientationEvidence::Orientations)?;
    let limit = |best: &SuspectedOrientation| best.with_convention < limit_rad;
    if !is_trajectory {
        return Some(of_estimate).filter(limit);
    }
    let scored: Vec<(Convention, f64)> = candidates(&Convention::AS_READ)
        .into_iter()
        .map(|candidate| (candidate, spread_of_both_rad(stated, &candidate)))
        .collect();
    let tie = SAME_SPREAD_RAD + (SAME_SPREAD - 1.0) * least(&scored);
    let of_truth = suspected(&scored, (as_read, tie), OrientationEvidence::Orientations)?;
    let of_truth = Some(of_truth).filter(limit);
    match (Some(of_estimate).filter(limit), of_truth) {
        (Some(best), Some(truth)) if truth.with_convention <= best.with_convention + tie => {
            let [is_usual, is_usual_truth] = [best.convention, truth.convention]
                .map(|convention| convention.world_axes.has_name());
            let is_as_good = best.with_convention <= truth.with_convention + tie;
            match is_as_good && (is_usual || !is_usual_truth) {
                true => Some(SuspectedOrientation { of_truth: Some(truth.convention), ..best }),
                false => Some(truth.blamed_on_truth(stated)),
            }
        }
        (None, Some(truth)) => Some(truth.blamed_on_truth(stated)),
        (best, _) => best,
    }
}

impl SuspectedOrientation {
    /// Returns the convention as that of the ground truth; the estimate's is the stated one.
    fn blamed_on_truth(self, stated: &Convention) -> Self {
        let of_truth = Some(self.convention);
        Self { convention: *stated, of_truth, alternatives: Vec::new(), ..self }
    }
}

fn least(scored: &[(Convention, f64)]) -> f64 {
    scored.iter().map(|(_, score)| *score).fold(f64::INFINITY, f64::min)
}

/// Returns the most usual of the conventions that fit best, and others that fit as well within a tolerance.
fn suspected(
    scored: &[(Convention, f64)],
    (as_read, tolerance): (f64, f64),
    evidence: OrientationEvidence,
) -> Option<SuspectedOrientation> {
    let best = least(scored);
    let fits = |score: f64| score <= best + tolerance;
    let mut fitting = scored.iter().filter(|(_, score)| fits(*score));
    let (convention, with_convention) = *fitting.next()?;
    let mut alternatives: Vec<Convention> = Vec::new();
    // A rotation of the world about the axis of the drive changes nothing. Worlds without a name are not usual.
    for (other, _) in fitting {
        let is_known = alternatives.iter().any(|known| operation(known) == operation(other));
        if operation(other) != operation(&convention) && other.world_axes.has_name() && !is_known {
            alternatives.push(*other);
        }
    }
    Some(SuspectedOrientation {
        convention,
        of_truth: None,
        alternatives,
        as_read,
        with_convention,
        evidence,
    })
}

/// Root mean square angle from the mean rotation (rad).
pub fn spread_rad(rotations: &[UnitQuaternion<f64>]) -> f64 {
    let sum: Matrix4<f64> =
        rotations.iter().map(|rotation| rotation.coords * rotation.coords.transpose()).sum();
    let eigen = sum.symmetric_eigen();
    let mean = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
    let mean = UnitQuaternion::from_quaternion(mean.into());
    let squares: f64 = rotations.iter().map(|rotation| rotation.angle_to(&mean).powi(2)).sum();
    (squares / rotations.len() as f64).sqrt()
}

/// A convention is reported by the lever arm if errors of positions are this many times larger as read, and if the blocks of the drive
/// agree.
/// Effect: a smaller ratio takes drift for another convention.
const LEVER_TIMES_BETTER: f64 = 1.08;
/// Conventions whose errors of positions differ by less than this share are not distinguished.
const SAME_ERROR: f64 = 0.02;

/// Errors of positions with the lever arm that fits best.
struct LeverFit {
    rmse_m: f64,
    /// Sum of squares of each block of the drive (m²).
    blocks_m2: Vec<f64>,
}

/// Compares conventions by the lever arm to a single prism, which only the right orientations turn as the body turns.
fn by_lever_arm(
    pairs: &[WrittenOrientation<'_>],
    fit: &Fit,
    stated: &Convention,
) -> Option<SuspectedOrientation> {
    let scored: Option<Vec<(Convention, f64)>> = candidates(stated)
        .into_iter()
        .map(|candidate| Some((candidate, lever_fit(pairs, fit, &candidate)?.rmse_m)))
        .collect();
    let (scored, as_read) = (scored?, lever_fit(pairs, fit, stated)?);
    let tie = (as_read.rmse_m, SAME_ERROR * least(&scored));
    let best = suspected(&scored, tie, OrientationEvidence::LeverArm)?;
    if as_read.rmse_m < LEVER_TIMES_BETTER * best.with_convention {
        return None;
    }
    let with_best = lever_fit(pairs, fit, &best.convention)?;
    (students_t(&as_read.blocks_m2, &with_best.blocks_m2) > SIGNIFICANT).then_some(best)
}

/// An odometry begins without rotation. With the other order of numbers, that is a half turn about x: it is reported if the first rotation is
/// below the first angle in one order, and beyond the second as read (rad), and if the lever arm does not contradict it.
/// Field: lever arms of handheld sensors are as small as their errors, so alone they show little. Few frames begin upside down.
const NOT_TURNED_RAD: f64 = 0.1;
const TURNED_RAD: f64 = 3.0;

fn by_first_orientation(
    poses: &[EstimatedPose],
    (pairs, fit): (&[WrittenOrientation<'_>], &Fit),
    stated: &Convention,
) -> Option<SuspectedOrientation> {
    let convention = Convention { has_w_first: !stated.has_w_first, ..*stated };
    let written = stated.as_written(poses.first()?.orientation?);
    let [as_read_rad, other_rad] =
        [stated, &convention].map(|convention| convention.orientation(written).angle());
    if as_read_rad < TURNED_RAD || other_rad > NOT_TURNED_RAD {
        return None;
    }
    let as_read = lever_fit(pairs, fit, stated)?;
    let other = lever_fit(pairs, fit, &convention)?;
    (students_t(&as_read.blocks_m2, &other.blocks_m2) > 0.0).then(|| SuspectedOrientation {
        convention,
        of_truth: None,
        alternatives: Vec::new(),
        as_read: as_read.rmse_m,
        with_convention: other.rmse_m,
        evidence: OrientationEvidence::LeverArm,
    })
}

fn lever_fit(
    pairs: &[WrittenOrientation<'_>],
    fit: &Fit,
    convention: &Convention,
) -> Option<LeverFit> {
    let frame = UnitQuaternion::from_rotation_matrix(&fit.truth_from_estimate.rotation);
    let centre_m = pairs.iter().map(|each| each.pair.truth.position_m).sum::<Vector3<f64>>()
        / pairs.len() as f64;
    let equations = |WrittenOrientation { pair, written }: &WrittenOrientation<'_>| {
        let placed_m = fit.truth_from_estimate.apply(&(fit.scale * pair.pose.position_m));
        let turned = (frame * convention.orientation(*written)).to_rotation_matrix();
        let arm_m = pair.truth.position_m - centre_m;
        let rows = position_rows(turned.matrix(), &arm_m, &pair.truth.velocity_m_per_s);
        (rows, pair.truth.position_m - placed_m)
    };
    let (mut normal, mut right) = (LeverNormal::zeros(), LeverVector::zeros());
    for (rows, residual_m) in pairs.iter().map(equations) {
        normal += rows.transpose() * rows;
        right += rows.transpose() * residual_m;
    }
    let solution = solve(normal, &right)?;
    let squares_m2: Vec<f64> = pairs
        .iter()
        .map(equations)
        .map(|(rows, residual_m)| (residual_m - rows * solution).norm_squared())
        .collect();
    Some(LeverFit {
        rmse_m: (squares_m2.iter().sum::<f64>() / squares_m2.len() as f64).sqrt(),
        blocks_m2: block_sums(&squares_m2),
    })
}

/// A convention is reported by the direction of travel if it scatters by less than the first angle in the body, by more than the
/// second as read (rad), and this many times more. Measured: a car and a robot with legs scatter by 2° to 6°, wrong conventions by 60° to 90°.
/// A person scatters by more, and another wrong convention had 17°.
const FORWARD_RAD: f64 = 0.2;
const ANY_DIRECTION_RAD: f64 = 0.8;
const TRAVEL_TIMES_BETTER: f64 = 2.5;
const SAME_TRAVEL_RAD: f64 = 0.05;

fn by_travel(poses: &[EstimatedPose], stated: &Convention) -> Option<SuspectedOrientation> {
    let travels: Vec<Travel> = travels(poses)
        .into_iter()
        .map(|travel| Travel { orientation: stated.as_written(travel.orientation), ..travel })
        .collect();
    let scatter_rad = |convention: &Convention| {
        scatter_in_body_rad(&travels, |written| convention.orientation(written))
    };
    let as_read = scatter_rad(stated)?;
    let scored: Option<Vec<(Convention, f64)>> = candidates(stated)
        .into_iter()
        .map(|candidate| Some((candidate, scatter_rad(&candidate)?)))
        .collect();
    let best = suspected(&scored?, (as_read, SAME_TRAVEL_RAD), OrientationEvidence::Travel)?;
    let is_forward = best.with_convention < FORWARD_RAD
        && as_read > ANY_DIRECTION_RAD.max(TRAVEL_TIMES_BETTER * best.with_convention);
    is_forward.then_some(best)
}
