//! Positions of left-handed axes, or with one axis reversed.
//!
//! On a flat drive, a rotation by half a turn hides a reversed axis: only heights and tilts contradict. So a lever arm is estimated, and
//! the blocks of the drive decide.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::block_comparison::{SIGNIFICANT, block_sums, students_t};
use super::lever_equations::{LeverNormal, LeverVector, motion, position_rows, solve};
use super::orientation_search::spread_rad;
use crate::estimates::conventions::{Convention, SignedAxes};
use crate::estimates::ground_truth::GroundTruth;
use crate::estimates::matched_pose::MatchedPose;
use crate::estimates::options::{Association, Options, TrajectoryAlignment};
use resect_core::deployment::EstimatedPose;
use resect_core::evaluation::no_trajectory::NoTrajectory;
use resect_core::geometry::align_similar;

/// Largest number of poses that are compared, and the fewest.
const MOST_POSES: usize = 1000;
const FEWEST: usize = 60;
/// Positions are mirrored if errors are this many times larger as read, and if the blocks of the drive agree.
/// Effect: a smaller ratio takes a drift of the heights for a reversed axis.
const TIMES_BETTER: f64 = 1.3;
/// Candidates whose errors differ by less than these ratios are not distinguished by the drive.
const SAME_ERROR: f64 = 1.02;
const SAME_ANGLE: f64 = 1.5;
/// Least cosine of the angle between the vertical axes of an upright estimate and of the ground truth.
const UPRIGHT: f64 = 0.9;
/// Axes of positions of which one is reversed, or two are exchanged.
const REVERSED: [[&str; 2]; 3] =
    [["x-yz", "y is reversed"], ["xy-z", "z is reversed"], ["yxz", "x and y are exchanged"]];

/// A convention without which the positions are mirrored.
#[derive(Clone, Debug, PartialEq)]
pub struct SuspectedHandedness {
    pub convention: Convention,
    /// Convention of a ground truth that would be mirrored instead; `None` if the estimate's orientations exclude that.
    pub of_truth: Option<Convention>,
    /// The error in words.
    pub words: &'static str,
    /// Root mean square errors of positions, as read and in the convention (m).
    pub rmse_m: [f64; 2],
}

/// Returns the convention in which the positions are right-handed; `None` if they are as read.
///
/// The poses are read with the convention of the options. The offset is added to their times (s).
pub fn suspected_handedness(
    truth: &GroundTruth<'_>,
    poses: &[EstimatedPose],
    offset_s: f64,
    options: &Options,
) -> Result<Option<SuspectedHandedness>, NoTrajectory> {
    let pairs = truth.matched(poses, offset_s, (Association::Interpolated, MOST_POSES))?;
    if options.alignment == TrajectoryAlignment::None || pairs.len() < FEWEST {
        return Ok(None);
    }
    Ok(best_mirrored(&pairs, &options.convention))
}

fn best_mirrored(pairs: &[MatchedPose], stated: &Convention) -> Option<SuspectedHandedness> {
    let as_read = MirroringFit::of(pairs, &Convention::AS_READ)?;
    let has_orientations = pairs.iter().all(|pair| pair.pose.orientation.is_some());
    let fits: Vec<(MirroringCandidate, MirroringFit)> = candidates(has_orientations, stated)
        .into_iter()
        .filter_map(|candidate| Some((MirroringFit::of(pairs, &candidate.added)?, candidate)))
        .map(|(fit, candidate)| (candidate, fit))
        .collect();
    let has_angle = fits.iter().all(|(_, fit)| fit.spread_rad.is_some());
    let score = |fit: &MirroringFit| fit.spread_rad.filter(|_| has_angle).unwrap_or(fit.rmse_m);
    let least = fits.iter().map(|(_, fit)| score(fit)).fold(f64::INFINITY, f64::min);
    let tolerance = if has_angle { SAME_ANGLE } else { SAME_ERROR };
    let same = || fits.iter().filter(|(_, fit)| score(fit) <= tolerance * least);
    let (candidate, fit) = same().find(|(_, fit)| fit.is_upright).or_else(|| same().next())?;
    let is_mirrored = as_read.rmse_m > TIMES_BETTER * fit.rmse_m
        && students_t(&as_read.blocks_m2, &fit.blocks_m2) > SIGNIFICANT;
    is_mirrored.then_some(SuspectedHandedness {
        convention: candidate.stated,
        of_truth: (candidate.added.is_left_handed || !has_orientations).then_some(candidate.added),
        words: candidate.words,
        rmse_m: [as_read.rmse_m, fit.rmse_m],
    })
}

/// A convention with mirrored positions.
struct MirroringCandidate {
    /// Convention that is applied to poses that were read with the stated one.
    added: Convention,
    /// Both as one.
    stated: Convention,
    words: &'static str,
}

/// Candidates, the usual ones first.
fn candidates(has_orientations: bool, stated: &Convention) -> Vec<MirroringCandidate> {
    let reversed = REVERSED.into_iter().filter_map(|[axes, words]| {
        let axes = SignedAxes::parse(axes)?;
        Some(MirroringCandidate {
            added: Convention { position_axes: axes, ..Convention::AS_READ },
            stated: Convention { position_axes: stated.position_axes.then(axes), ..*stated },
            words,
        })
    });
    let is_left_handed = !stated.is_left_handed;
    let all = MirroringCandidate {
        added: Convention { is_left_handed: true, ..Convention::AS_READ },
        stated: Convention { is_left_handed, ..*stated },
        words: "all axes are left-handed",
    };
    has_orientations.then_some(all).into_iter().chain(reversed).collect()
}

/// Fit of positions with a scale, a lever arm and a time offset.
struct MirroringFit {
    rmse_m: f64,
    /// Sum of squared errors in each block of the drive (m²).
    blocks_m2: Vec<f64>,
    /// Scatter of the body's rotation in the vehicle (rad); `None` if one of the two has no orientations.
    spread_rad: Option<f64>,
    is_upright: bool,
}

impl MirroringFit {
    fn of(pairs: &[MatchedPose], convention: &Convention) -> Option<Self> {
        let poses: Vec<EstimatedPose> =
            pairs.iter().map(|pair| convention.pose(&pair.pose)).collect();
        let true_m: Vec<Vector3<f64>> = pairs.iter().map(|pair| pair.truth.position_m).collect();
        let own_m: Vec<Vector3<f64>> = poses.iter().map(|pose| pose.position_m).collect();
        let (frame, scale) = align_similar(&true_m, &own_m)?;
        let centre_m = true_m.iter().sum::<Vector3<f64>>() / true_m.len() as f64;
        let equations = |(pair, pose): (&MatchedPose, &EstimatedPose)| {
            let placed_m = frame.apply(&(scale * pose.position_m));
            // The lever arm is that of the body with orientations: added to the estimate, or subtracted from the ground truth.
            let axes = match (&pair.truth.rotation, pose.orientation) {
                (Some(rotation), _) => -rotation.orientation.to_rotation_matrix().into_inner(),
                (None, Some(body)) => (frame.rotation * body.to_rotation_matrix()).into_inner(),
                (None, None) => Matrix3::zeros(),
            };
            let [velocity, _] = motion(pair, &frame, scale);
            let rows = position_rows(&axes, &(placed_m - centre_m), &velocity);
            (rows, pair.truth.position_m - placed_m)
        };
        let (mut normal, mut right) = (LeverNormal::zeros(), LeverVector::zeros());
        for (rows, error_m) in pairs.iter().zip(&poses).map(equations) {
            normal += rows.transpose() * rows;
            right += rows.transpose() * error_m;
        }
        let solution = solve(normal, &right)?;
        let squares_m2: Vec<f64> = pairs
            .iter()
            .zip(&poses)
            .map(equations)
            .map(|(rows, error_m)| (error_m - rows * solution).norm_squared())
            .collect();
        Some(Self {
            rmse_m: (squares_m2.iter().sum::<f64>() / squares_m2.len() as f64).sqrt(),
            blocks_m2: block_sums(&squares_m2),
            spread_rad: spread_of_bodies_rad(pairs, &poses, &frame.rotation),
            is_upright: frame.rotation[(2, 2)] > UPRIGHT,
        })
    }
}

fn spread_of_bodies_rad(
    pairs: &[MatchedPose],
    poses: &[EstimatedPose],
    frame: &Rotation3<f64>,
) -> Option<f64> {
    let bodies: Option<Vec<_>> = pairs
        .iter()
        .zip(poses)
        .map(|(pair, pose)| {
            let truth = pair.truth.rotation.as_ref()?.orientation;
            Some(truth.inverse() * *frame * pose.orientation?)
        })
        .collect();
    bodies.map(|bodies| spread_rad(&bodies))
}
