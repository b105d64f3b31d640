//! Search for the convention in which an estimate's orientations follow those of the ground truth.
//!
//! In the right convention the body is fixed in the vehicle: R_truthᵀ R_frame W op(q) is constant over the drive, for any body.
//! W is one of the 24 rotations of axes, and op the order of the quaternion's numbers and its inverse. A permutation of the
//! body's axes is a part of the constant. Each W has a twin: inverse and w first are together a rotation of axes of world and
//! body, so the more usual one of the two is reported.
//!
//! A single prism has no orientation. The lever arm to it turns as the body turns, and most bodies travel forward
//! ([`super::travel_direction`]).

use nalgebra::{Matrix4, Rotation3, SMatrix, SVector, UnitQuaternion, Vector3};

use super::travel_direction::{Travel, scatter_in_body_rad, travels};
use crate::estimates::conventions::{Convention, Inverted, SignedAxes};
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

/// Returns the convention that fits much better than the stated one, with which the poses were read; `None` if there is none.
pub fn suspected_orientation(
    poses: &[EstimatedPose],
    pairs: &[MatchedPose],
    fit: &Fit,
    stated: &Convention,
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
        by_orientations(&pairs, &fit.truth_from_estimate.rotation, stated)
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

/// Conventions of orientations, the usual ones first.
fn candidates(stated: &Convention) -> Vec<Convention> {
    let operations = [
        (false, Inverted::Nothing),
        (true, Inverted::Nothing),
        (false, Inverted::Orientations),
        (true, Inverted::Orientations),
    ];
    let with = |world_axes| {
        operations.map(|(has_w_first, inverted)| Convention {
            has_w_first,
            inverted,
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
) -> Option<SuspectedOrientation> {
    let frame = UnitQuaternion::from_rotation_matrix(frame);
    let spread_rad = |convention: &Convention| {
        let bodies = pairs.iter().filter_map(|each| {
            let truth = each.pair.truth.rotation.as_ref()?.orientation;
            Some(truth.inverse() * frame * convention.orientation(each.written))
        });
        spread_rad(&bodies.collect::<Vec<_>>())
    };
    let scored: Vec<(Convention, f64)> = candidates(stated)
        .into_iter()
        .map(|candidate| (candidate, spread_rad(&candidate)))
        .collect();
    let as_read = spread_rad(stated);
    let limit_rad = LARGEST_SPREAD_RAD.min(as_read / TIMES_BETTER);
    let tie = SAME_SPREAD_RAD + (SAME_SPREAD - 1.0) * least(&scored);
    suspected(&scored, (as_read, tie), OrientationEvidence::Orientations)
        .filter(|best| best.with_convention < limit_rad)
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
    let operation = |convention: &Convention| (convention.has_w_first, convention.inverted);
    for (other, _) in fitting {
        let is_known = alternatives.iter().any(|known| operation(known) == operation(other));
        if operation(other) != operation(&convention) && other.world_axes.has_name() && !is_known {
            alternatives.push(*other);
        }
    }
    Some(SuspectedOrientation { convention, alternatives, as_read, with_convention, evidence })
}

/// Root mean square angle from the mean rotation (rad).
fn spread_rad(rotations: &[UnitQuaternion<f64>]) -> f64 {
    let sum: Matrix4<f64> =
        rotations.iter().map(|rotation| rotation.coords * rotation.coords.transpose()).sum();
    let eigen = sum.symmetric_eigen();
    let mean = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
    let mean = UnitQuaternion::from_quaternion(mean.into());
    let squares: f64 = rotations.iter().map(|rotation| rotation.angle_to(&mean).powi(2)).sum();
    (squares / rotations.len() as f64).sqrt()
}

/// A convention is reported by the lever arm if errors of positions are this many times larger as read, and if the blocks of the drive
/// agree: Student's t of 11 degrees of freedom exceeds 5 once in 2500 drives.
/// Effect: a smaller ratio takes drift for another convention.
const LEVER_TIMES_BETTER: f64 = 1.08;
const LEVER_SIGNIFICANT: f64 = 5.0;
const BLOCKS: usize = 12;
/// Unknowns of the fit of a lever arm: lever arm, translation, small rotation, and clock.
const LEVER_UNKNOWNS: usize = 10;
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
    (significance(&as_read, &with_best) > LEVER_SIGNIFICANT).then_some(best)
}

/// Returns Student's t of the logarithms of the ratios of squares, over the blocks of the drive.
fn significance(as_read: &LeverFit, other: &LeverFit) -> f64 {
    let blocks = as_read.blocks_m2.iter().zip(&other.blocks_m2);
    let ratios: Vec<f64> = blocks.map(|(as_read, other)| (as_read / other).ln()).collect();
    let count = ratios.len() as f64;
    let mean = ratios.iter().sum::<f64>() / count;
    let variance = ratios.iter().map(|ratio| (ratio - mean).powi(2)).sum::<f64>() / (count - 1.0);
    mean / (variance / count).sqrt().max(f64::MIN_POSITIVE)
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
    (significance(&as_read, &other) > 0.0).then(|| SuspectedOrientation {
        convention,
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
        let mut rows = SMatrix::<f64, 3, LEVER_UNKNOWNS>::zeros();
        rows.fixed_view_mut::<3, 3>(0, 0).copy_from(turned.matrix());
        rows.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
        let arm_m = pair.truth.position_m - centre_m;
        rows.fixed_view_mut::<3, 3>(0, 6).copy_from(&arm_m.cross_matrix());
        rows.fixed_view_mut::<3, 1>(0, 9).copy_from(&pair.truth.velocity_m_per_s);
        (rows, pair.truth.position_m - placed_m)
    };
    let mut normal = SMatrix::<f64, LEVER_UNKNOWNS, LEVER_UNKNOWNS>::zeros();
    let mut right = SVector::<f64, LEVER_UNKNOWNS>::zeros();
    for (rows, residual_m) in pairs.iter().map(equations) {
        normal += rows.transpose() * rows;
        right += rows.transpose() * residual_m;
    }
    // A part of the unknowns is not determined by a level drive.
    let ridge = 1e-9 * normal.trace();
    (0..LEVER_UNKNOWNS).for_each(|k| normal[(k, k)] += ridge);
    let solution = normal.cholesky()?.solve(&right);
    let squares_m2: Vec<f64> = pairs
        .iter()
        .map(equations)
        .map(|(rows, residual_m)| (residual_m - rows * solution).norm_squared())
        .collect();
    let blocks = squares_m2.chunks(squares_m2.len().div_ceil(BLOCKS));
    Some(LeverFit {
        rmse_m: (squares_m2.iter().sum::<f64>() / squares_m2.len() as f64).sqrt(),
        blocks_m2: blocks.map(|block| block.iter().sum()).collect(),
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
