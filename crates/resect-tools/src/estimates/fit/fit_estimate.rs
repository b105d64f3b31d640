//! The Gauss–Newton iteration that fits an estimate to the ground truth.

use nalgebra::{DMatrix, DVector, Rotation3, Vector3};

use super::body::turn_body;
use super::fit::Fit;
use super::pieces::{Pieces, by_common};
use super::state::{CLOCK, FitState, LEVER, SCALE, UNKNOWNS};
use crate::estimates::ground_truth::GroundTruth;
use crate::estimates::matched_pose::{MatchedPose, consistent};
use crate::estimates::options::{Association, Body, Options, TrajectoryAlignment};
use crate::estimates::time_offset::{self, CoarseOffset};
use crate::estimates::unfit::Unfit;
use crate::estimates::unjudged::Unjudged;
use crate::findings::studies::{estimate_clock_far_off, estimate_few_points, estimate_scale_off};
use resect_core::calibration::Estimate;
use resect_core::deployment::{EstimatedPose, EstimatedTrajectory};
use resect_core::geometry::{RigidTransform, align_rigid, align_similar};
use resect_core::statistics::{median, sandwich};

/// Largest number of epochs in a fit, evenly spread.
const MOST_EPOCHS: usize = 4000;
const MOST_STEPS: usize = 300;
/// Clock and lever arm have converged if a step is smaller than this (s, m).
const SETTLED: f64 = 1e-5;
/// Steps that shrink less than this ratio oscillate, such as where the estimate stands still, and are damped.
const OSCILLATES: f64 = 0.98;
/// Change of the time offset (s) above which the ground truth is recomputed, and not moved along its velocity: during the
/// iteration, and before its end.
const LINEAR_S: f64 = 0.01;
const EXACT_S: f64 = 1e-4;
const FEWEST_EPOCHS: usize = 10;
/// Fewest pairs by which a frame is aligned, if clock and lever arm are not estimated.
const FEWEST_POINTS: usize = 4;
/// Clocks that differ by more than this (s) have different origins, such as 1970 and the start.
const FAR_S: f64 = 60.0;
/// Relative misfit beyond which an estimate with times elsewhere is of another drive. Aligned paths of two drives differ by half of their
/// size; a drift of a fifth is rare.
const OTHER_DRIVE: f64 = 0.2;

/// Poses that fit this many times better in another convention are in that one.
const OTHER_CONVENTION: f64 = 3.0;

/// Fits an estimate to the ground truth, and returns the pairs of its poses and the ground truth as well.
pub fn fit(
    truth: &GroundTruth<'_>,
    estimate: &EstimatedTrajectory,
    options: &Options,
) -> Result<(Fit, Vec<MatchedPose>), Unjudged> {
    let unfit = |why| Unjudged::Unfit { name: estimate.name.clone(), why };
    let poses = &estimate.poses;
    if poses.len() < FEWEST_EPOCHS {
        return Err(unfit(Unfit::FewPoses(poses.len())));
    }
    let turning = truth.has_orientation() || poses.iter().all(|pose| pose.orientation.is_some());
    if matches!(options.body, Body::Lever(_)) && !turning {
        return Err(unfit(Unfit::NoOrientation));
    }
    let CoarseOffset { offset_s, sigma_s } = match options.time_offset_s {
        Some(offset_s) => CoarseOffset { offset_s, sigma_s: None },
        None => time_offset::coarse(poses, truth)?.ok_or_else(|| unfit(Unfit::NoOverlap))?,
    };
    let mut sought = Sought {
        frame: options.alignment,
        clock: options.time_offset_s.is_none(),
        lever: options.body == Body::Found && turning,
    };
    let mut state = FitState {
        fit: initial(offset_s, options.body, turning),
        later_s: 0.0,
        offset_prior: sigma_s.map(|sigma_s| Estimate { value: offset_s, sigma: sigma_s }),
        pivot_m: poses.iter().map(|pose| pose.position_m).sum::<Vector3<f64>>()
            / poses.len() as f64,
    };
    let association = options.association;
    if sought.clock || sought.lever {
        let pairs = truth.matched(poses, offset_s, (association, MOST_EPOCHS))?;
        refuse_other_conventions(&pairs, options.alignment).map_err(unfit)?;
        if pairs.len() < FEWEST_EPOCHS && pairs.len() >= FEWEST_POINTS {
            let point = estimate_few_points(&estimate.name, pairs.len());
            state.fit.findings.push(point);
        } else {
            // Selected once: a set that changes with the clock would prevent convergence.
            let pairs = consistent(&pairs);
            align(&mut state.fit, &pairs, sought.frame).map_err(unfit)?;
            let chosen: Vec<EstimatedPose> = match truth {
                GroundTruth::Deployment { .. } => pairs.iter().map(|pair| pair.pose).collect(),
                GroundTruth::Trajectory(..) => poses.clone(),
            };
            let longer =
                times_longer(&pairs).filter(|_| sought.frame == TrajectoryAlignment::Rigid);
            refine(&mut state, (truth, association), &chosen, &mut sought, estimate).map_err(
                |why| match (&why, longer) {
                    (Unjudged::Unfit { why: Unfit::Undetermined, .. }, Some(longer)) => {
                        unfit(Unfit::OtherScale(longer))
                    }
                    _ => why,
                },
            )?;
        }
    }
    let mut fit = state.fit;
    if options.time_offset_s.is_none() && fit.time_offset_s.abs() > FAR_S {
        fit.findings.push(estimate_clock_far_off(&estimate.name, -fit.time_offset_s));
    }
    let pairs = truth.matched(poses, fit.time_offset_s, (association, usize::MAX))?;
    align(&mut fit, &pairs, options.alignment).map_err(unfit)?;
    if let Some(longer) =
        times_longer(&pairs).filter(|_| options.alignment == TrajectoryAlignment::Rigid)
    {
        let why = Unfit::OtherScale(longer).to_string();
        fit.findings.push(estimate_scale_off(&estimate.name, longer, &why));
    }
    turn_body(&mut fit, &pairs, options.body == Body::Same);
    let misfit = relative_misfit(&fit, &pairs);
    if options.time_offset_s.is_none() && are_apart(poses, &pairs) && misfit > OTHER_DRIVE {
        return Err(unfit(Unfit::OtherDrive(100.0 * misfit)));
    }
    Ok((fit, pairs))
}

/// Returns true if the estimate's own stamps do not overlap the times of the ground truth.
fn are_apart(poses: &[EstimatedPose], pairs: &[MatchedPose]) -> bool {
    let times_s = || pairs.iter().map(|pair| pair.truth.time_s);
    let (from_s, to_s) =
        (times_s().fold(f64::INFINITY, f64::min), times_s().fold(f64::NEG_INFINITY, f64::max));
    let overlaps =
        |first: &EstimatedPose, last: &EstimatedPose| first.time_s <= to_s && last.time_s >= from_s;
    poses.first().zip(poses.last()).is_some_and(|(first, last)| !overlaps(first, last))
}

/// Returns the root mean square position error relative to the root mean square extent of the ground truth.
fn relative_misfit(fit: &Fit, pairs: &[MatchedPose]) -> f64 {
    let both_m: Vec<[Vector3<f64>; 2]> =
        pairs.iter().map(|pair| fit.both_positions_m(&pair.pose, &pair.truth)).collect();
    let mean_m =
        both_m.iter().map(|[_, true_m]| true_m).sum::<Vector3<f64>>() / both_m.len() as f64;
    let error_m2: f64 = both_m.iter().map(|[own_m, true_m]| (own_m - true_m).norm_squared()).sum();
    let extent_m2: f64 = both_m.iter().map(|[_, true_m]| (true_m - mean_m).norm_squared()).sum();
    (error_m2 / extent_m2).sqrt()
}

/// The fit before any estimation; `turning` is true if anything has orientations.
fn initial(time_offset_s: f64, body: Body, turning: bool) -> Fit {
    Fit {
        truth_from_estimate: RigidTransform {
            rotation: Rotation3::identity(),
            translation_m: Vector3::zeros(),
        },
        scale: 1.0,
        time_offset_s,
        time_offset_sigma_s: None,
        determines_time_offset: true,
        lever_arm_m: turning.then(|| match body {
            Body::Lever(lever_m) => lever_m,
            Body::Found | Body::Same => Vector3::zeros(),
        }),
        lever_arm_sigma_m: None,
        body_rotation: None,
        body_rotation_sigma_rad: None,
        findings: Vec::new(),
    }
}

/// Unknowns to estimate.
struct Sought {
    frame: TrajectoryAlignment,
    clock: bool,
    lever: bool,
}

/// Returns an error if the positions fit much better with one axis reversed (they are left-handed) or with the inverse of each pose
/// (they are those of the world in the body). The fits ignore the lever arm.
fn refuse_other_conventions(
    pairs: &[MatchedPose],
    alignment: TrajectoryAlignment,
) -> Result<(), Unfit> {
    if alignment == TrajectoryAlignment::None {
        return Ok(());
    }
    let truth_m: Vec<Vector3<f64>> = pairs.iter().map(|pair| pair.truth.position_m).collect();
    let misfit_m = |position: &dyn Fn(&EstimatedPose) -> Option<Vector3<f64>>| {
        let own_m: Option<Vec<Vector3<f64>>> =
            pairs.iter().map(|pair| position(&pair.pose)).collect();
        let own_m = own_m?;
        let (transform, scale) = align_similar(&truth_m, &own_m)?;
        let off_m = |(truth_m, own_m): (&Vector3<f64>, &Vector3<f64>)| {
            (truth_m - transform.apply(&(own_m * scale))).norm()
        };
        median(truth_m.iter().zip(&own_m).map(off_m))
    };
    let Some(as_read_m) = misfit_m(&|pose| Some(pose.position_m)) else { return Ok(()) };
    let is_better = |other_m: &f64| as_read_m > OTHER_CONVENTION * other_m;
    let up = Vector3::new(1.0, 1.0, -1.0);
    if let Some(mirrored_m) =
        misfit_m(&|pose| Some(pose.position_m.component_mul(&up))).filter(is_better)
    {
        return Err(Unfit::Mirrored(as_read_m / mirrored_m));
    }
    match misfit_m(&|pose| Some(-(pose.orientation?.inverse() * pose.position_m))).filter(is_better)
    {
        Some(inverse_m) => Err(Unfit::Inverse(as_read_m / inverse_m)),
        None => Ok(()),
    }
}

/// Returns the ratio of the estimate's path lengths to the ground truth's; `None` if it is within drift. A larger ratio is
/// another unit, or the scale of a single camera. It is the median over paths that are long beside lever arms, which does not depend
/// on frames and errors.
fn times_longer(pairs: &[MatchedPose]) -> Option<f64> {
    const SHORTEST_M: f64 = 2.0;
    const WAYS: f64 = 10.0;
    const DRIFT: f64 = 1.1;
    let first_m = pairs.first()?.truth.position_m;
    let away_m = pairs.iter().map(|pair| (pair.truth.position_m - first_m).norm());
    let way_m = (away_m.fold(0.0, f64::max) / WAYS).max(SHORTEST_M);
    let (mut from, mut ratios) = (0, Vec::new());
    for (to, MatchedPose { pose, truth, .. }) in pairs.iter().enumerate() {
        let MatchedPose { pose: first, truth: first_true, .. } = &pairs[from];
        let true_m = (truth.position_m - first_true.position_m).norm();
        if true_m >= way_m {
            ratios.push((pose.position_m - first.position_m).norm() / true_m);
            from = to;
        }
    }
    median(ratios).filter(|longer| *longer > 0.0 && !(DRIFT.recip()..DRIFT).contains(longer))
}

/// Aligns the frame by plain least squares, with fixed clock and lever arm.
pub fn align(
    fit: &mut Fit,
    pairs: &[MatchedPose],
    alignment: TrajectoryAlignment,
) -> Result<(), Unfit> {
    if pairs.len() < FEWEST_POINTS {
        return Err(Unfit::FewEpochs);
    }
    if alignment == TrajectoryAlignment::None {
        return Ok(());
    }
    let lever_m = fit.lever_arm_m.unwrap_or_default();
    let of_truth: Vec<Vector3<f64>> = pairs
        .iter()
        .map(|MatchedPose { truth, .. }| match &truth.rotation {
            Some(rotation) => truth.position_m + rotation.orientation * lever_m,
            None => truth.position_m,
        })
        .collect();
    let own: Vec<Vector3<f64>> = pairs
        .iter()
        .map(|MatchedPose { pose, truth, .. }| match (&truth.rotation, pose.orientation) {
            // The length of the lever arm does not depend on the scale.
            (None, Some(own)) => pose.position_m + own * lever_m / fit.scale,
            _ => pose.position_m,
        })
        .collect();
    let found = match alignment {
        TrajectoryAlignment::Similarity => align_similar(&of_truth, &own),
        _ => align_rigid(&of_truth, &own).map(|transform| (transform, 1.0)),
    };
    (fit.truth_from_estimate, fit.scale) = found.ok_or(Unfit::OnALine)?;
    Ok(())
}

/// Estimates frame, lever arm and clock together, with σ of the latter two.
fn refine(
    state: &mut FitState,
    (truth, association): (&GroundTruth<'_>, Association),
    poses: &[EstimatedPose],
    sought: &mut Sought,
    estimate: &EstimatedTrajectory,
) -> Result<(), Unjudged> {
    let unfit = |why| Unjudged::Unfit { name: estimate.name.clone(), why };
    let open = |sought: &Sought| -> Vec<usize> {
        let frame = match sought.frame {
            TrajectoryAlignment::None => 0..0,
            TrajectoryAlignment::Rigid => 0..SCALE,
            TrajectoryAlignment::Similarity => 0..SCALE + 1,
        };
        let lever = if sought.lever { LEVER..CLOCK } else { 0..0 };
        let clock = if sought.clock { CLOCK..UNKNOWNS } else { 0..0 };
        frame.chain(lever).chain(clock).collect()
    };
    let open = open(sought);
    let mut asked_s = state.fit.time_offset_s;
    let matched = |offset_s: f64| truth.matched(poses, offset_s, (association, MOST_EPOCHS));
    let mut pairs = matched(asked_s)?;
    let (mut damping, mut last_change) = (1.0, f64::INFINITY);
    for _ in 0..MOST_STEPS {
        if pairs.len() < FEWEST_EPOCHS {
            return Err(unfit(Unfit::FewEpochs));
        }
        let pieces = Pieces::of(&pairs, state);
        let (blocks, prior) = (pieces.blocks(&open), state.prior_precision(&open));
        let mut information = DMatrix::from_diagonal(&prior);
        let mut gradient = DVector::zeros(open.len());
        for block in &blocks {
            information += &block.information;
            gradient += &block.gradient;
        }
        let now = DVector::from_iterator(open.len(), open.iter().map(|k| state.value(*k)));
        gradient -= prior.component_mul(&now);
        let root = information.cholesky().ok_or_else(|| unfit(Unfit::Undetermined))?;
        let step = root.solve(&gradient);
        let change = state.step(&open, &(damping * step));
        if change > OSCILLATES * last_change {
            damping *= 0.5;
        }
        last_change = change;
        let settled = change < SETTLED;
        if state.later_s.abs() > if settled { EXACT_S } else { LINEAR_S } {
            state.later_s = 0.0;
            asked_s = state.fit.time_offset_s;
            pairs = matched(asked_s)?;
        } else if settled {
            let prior = sandwich::Prior { precision: prior, weight: 1.0 };
            let mut covariance = sandwich::covariance(&blocks, Some(&prior))
                .ok_or_else(|| unfit(Unfit::Undetermined))?;
            let times_s: Vec<f64> = pairs.iter().map(|pair| pair.truth.time_s).collect();
            if let Some(common) = truth.common_errors(&times_s) {
                let moved = root.solve(&by_common(&pieces, &open, state, &common));
                covariance += &moved * &common.covariance * moved.transpose();
            }
            state.take_sigmas(&open, &covariance);
            return Ok(());
        }
    }
    Err(unfit(Unfit::Undetermined))
}
