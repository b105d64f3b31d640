//! The fit of an estimate to the ground truth: coarse offset, conventions, iteration, and alignment.

use nalgebra::{Rotation3, UnitQuaternion, Vector3};

use super::alignment::{FEWEST_POINTS, align};
use super::clock_change::ClockChange;
use super::fit::{Fit, FitCovariance};
use super::refine::{FEWEST_EPOCHS, Sought, mean_turn, orientations_follow, refine};
use super::state::FitState;
use crate::estimates::conventions::{Convention, Inverted};
use crate::estimates::ground_truth::GroundTruth;
use crate::estimates::matched_pose::{MatchedPose, consistent};
use crate::estimates::options::{Body, Options, TrajectoryAlignment};
use crate::estimates::time_offset::{self, CoarseOffset};
use crate::estimates::trajectory_summary::extent_m;
use crate::estimates::unfit::Unfit;
use crate::estimates::unjudged::Unjudged;
use crate::findings::studies::{
    estimate_clock_drifts, estimate_clock_far_off, estimate_clock_stepped, estimate_clock_wanders,
    estimate_few_points, estimate_scale_off, estimate_stamps_jitter,
};
use resect_core::calibration::Estimate;
use resect_core::deployment::{EstimatedPose, EstimatedTrajectory, Finding};
use resect_core::geometry::{RigidTransform, align_similar};
use resect_core::statistics::median;

/// Largest number of epochs by which clock and conventions are checked first, evenly spread.
const MOST_EPOCHS: usize = 4000;
/// Clocks that differ by more than this (s) have different origins, such as 1970 and the start.
const FAR_S: f64 = 60.0;
/// Clocks that differ by less are those of the stamps (s).
const NEAR_S: f64 = 0.5;
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
    let CoarseOffset { offset_s, sigma_s, rivals_s } =
        match options.time_offset_s.or(options.near_offset_s) {
            Some(offset_s) => CoarseOffset { offset_s, sigma_s: None, rivals_s: Vec::new() },
            None => time_offset::coarse(poses, truth)?.ok_or_else(|| unfit(Unfit::NoOverlap))?,
        };
    let offset_s = best_by_positions(offset_s, &rivals_s, truth, (estimate, options))?;
    let has_orientation = truth.has_orientation();
    let mut sought = Sought {
        frame: options.alignment,
        clock: options.time_offset_s.is_none(),
        lever: options.body == Body::Found && turning,
        body: options.body != Body::Same
            && has_orientation
            && poses.iter().all(|pose| pose.orientation.is_some()),
    };
    let mut state = FitState {
        fit: initial(offset_s, options.body, turning),
        later_s: 0.0,
        offset_prior: sigma_s.map(|sigma_s| Estimate { value: offset_s, sigma: sigma_s }),
        is_scaled: options.alignment == TrajectoryAlignment::Similarity,
        aligned: Rotation3::identity(),
        share_of_estimate: 1.0,
        is_turned_by_estimate: false,
        share_of_stamped: 1.0,
        pivot_m: poses.iter().map(|pose| pose.position_m).sum::<Vector3<f64>>()
            / poses.len() as f64,
    };
    estimate_unknowns(&mut state, truth, estimate, &mut sought, options)?;
    let is_scaled = state.is_scaled;
    let mut fit = state.fit;
    if !is_scaled {
        fit.scale = 1.0;
    }
    if options.time_offset_s.is_none() && fit.time_offset_s.abs() > FAR_S {
        fit.findings.push(estimate_clock_far_off(&estimate.name, -fit.time_offset_s));
    }
    if let Some(change) = fit.clock_change {
        let start_s = truth.start_s().unwrap_or_default();
        let convention = &options.convention;
        fit.findings.push(clock_finding(&estimate.name, change, (start_s, convention)));
    }
    let mut pairs = truth.matched(poses, fit.time_offset_s, (options.association, usize::MAX))?;
    let whole = pairs.len();
    pairs.retain(|pair| options.has_time(pair.truth.time_s));
    if pairs.len() < FEWEST_POINTS && whole >= FEWEST_POINTS {
        return Err(unfit(Unfit::EmptySpan(pairs.len())));
    }
    let first = &pairs[..options.align_first.unwrap_or(usize::MAX).min(pairs.len())];
    align(&mut fit, first, options.alignment).map_err(|why| match why {
        Unfit::OnALine if first.len() < pairs.len() => unfit(Unfit::FirstOnALine(first.len())),
        why => unfit(why),
    })?;
    if let Some(longer) =
        times_longer(&pairs).filter(|_| options.alignment == TrajectoryAlignment::Rigid)
    {
        let why = Unfit::OtherScale(longer).to_string();
        fit.findings.push(estimate_scale_off(&estimate.name, longer, &why));
    }
    if options.body == Body::Same {
        fit.body_rotation = mean_turn(&fit, &pairs).map(|_| UnitQuaternion::identity());
    } else if fit.body_rotation_sigma_rad.is_none() {
        fit.body_rotation = mean_turn(&fit, &pairs);
    }
    let misfit = relative_misfit(&fit, &pairs);
    if options.time_offset_s.is_none() && are_apart(poses, &pairs) && misfit > OTHER_DRIVE {
        return Err(unfit(Unfit::OtherDrive(100.0 * misfit)));
    }
    Ok((fit, pairs))
}

/// Estimates clock, lever arm and body if there are enough pairs for them.
fn estimate_unknowns(
    state: &mut FitState,
    truth: &GroundTruth<'_>,
    estimate: &EstimatedTrajectory,
    sought: &mut Sought,
    options: &Options,
) -> Result<(), Unjudged> {
    if !sought.any() {
        return Ok(());
    }
    let unfit = |why| Unjudged::Unfit { name: estimate.name.clone(), why };
    let (poses, association) = (&estimate.poses, options.association);
    let pairs = truth.matched(poses, state.fit.time_offset_s, (association, MOST_EPOCHS))?;
    refuse_other_conventions(truth, &pairs, options).map_err(unfit)?;
    // Speeds of inverse poses are others, so that their time offset may be wrong.
    if options.time_offset_s.is_none() && state.fit.time_offset_s.abs() > NEAR_S {
        let as_stamped = truth.matched(poses, 0.0, (association, MOST_EPOCHS))?;
        if as_stamped.len() >= FEWEST_EPOCHS {
            refuse_other_conventions(truth, &as_stamped, options).map_err(unfit)?;
        }
    }
    if pairs.len() < FEWEST_EPOCHS && pairs.len() >= FEWEST_POINTS {
        state.fit.findings.push(estimate_few_points(&estimate.name, pairs.len()));
        return Ok(());
    }
    // Selected once: a set that changes with the clock would prevent convergence.
    let pairs = consistent(&pairs);
    align(&mut state.fit, &pairs, sought.frame).map_err(unfit)?;
    sought.body &= orientations_follow(&state.fit, &pairs);
    let chosen: Vec<EstimatedPose> = match truth {
        GroundTruth::Deployment { .. } => pairs.iter().map(|pair| pair.pose).collect(),
        GroundTruth::Trajectory(..) => poses.clone(),
    };
    let longer = times_longer(&pairs).filter(|_| sought.frame == TrajectoryAlignment::Rigid);
    let misfit = misfit_with_scale(&state.fit, &pairs);
    let is_apart = options.time_offset_s.is_none() && are_apart(poses, &pairs);
    let refined = refine(state, (truth, association), &chosen, sought, estimate);
    if !matches!(refined, Err(Unjudged::Unfit { why: Unfit::Undetermined, .. })) {
        return refined;
    }
    Err(unfit(match longer {
        _ if misfit > OTHER_DRIVE && is_apart => Unfit::OtherDrive(100.0 * misfit),
        Some(longer) if misfit < OTHER_DRIVE => Unfit::OtherScale(longer),
        _ if misfit > OTHER_DRIVE => Unfit::OtherShape(100.0 * misfit),
        _ => Unfit::Undetermined,
    }))
}

/// Returns the relative misfit of the pairs after an alignment with a scale.
fn misfit_with_scale(fit: &Fit, pairs: &[MatchedPose]) -> f64 {
    let mut scaled = fit.clone();
    match align(&mut scaled, pairs, TrajectoryAlignment::Similarity) {
        Ok(()) => relative_misfit(&scaled, pairs),
        Err(_) => f64::INFINITY,
    }
}

/// Digits of a factor on times. Effect: a millionth is a millisecond in a quarter of an hour.
const RATE_STEPS: f64 = 1e6;

/// Finding about a time offset that is not constant; `start_s` is the first time of the ground truth, and the convention that of the estimate.
fn clock_finding(
    name: &str,
    change: ClockChange,
    (start_s, stated): (f64, &Convention),
) -> Finding {
    match change {
        ClockChange::Step { time_s, by_s } => estimate_clock_stepped(name, -by_s, time_s - start_s),
        ClockChange::Drift { per_s } => {
            let factor = stated.time_s * ((RATE_STEPS * (1.0 + per_s)).round() / RATE_STEPS);
            let flag = Convention { time_s: factor, ..*stated }.to_string();
            estimate_clock_drifts(name, -per_s, &flag)
        }
        ClockChange::Jitter { sigma_s } => estimate_stamps_jitter(name, sigma_s),
        ClockChange::Wander { sigma_s } => estimate_clock_wanders(name, sigma_s),
    }
}

/// Largest number of epochs by which time offsets are compared, and the ratio of misfits that decides between two.
/// Effect: a smaller ratio takes a place that looks alike for the right one. Field: of two seconds apart, positions differ by metres.
const MOST_COMPARED: usize = 400;
const DECISIVE_RATIO: f64 = 1.5;
/// Misfits below this one do not differ (m): lever arm and tenths of a second are not estimated yet.
const LEAST_MISFIT_M: f64 = 0.1;
/// Smallest share of the poses that have ground truth at an offset, relative to the best.
const LEAST_COMMON: f64 = 0.7;

/// Returns the offset at which the aligned positions fit best (s); an error if another one fits nearly as well.
fn best_by_positions(
    offset_s: f64,
    rivals_s: &[f64],
    truth: &GroundTruth<'_>,
    (estimate, options): (&EstimatedTrajectory, &Options),
) -> Result<f64, Unjudged> {
    if rivals_s.is_empty() {
        return Ok(offset_s);
    }
    let mut misfits: Vec<(f64, f64, usize)> = Vec::new();
    for offset_s in std::iter::once(offset_s).chain(rivals_s.iter().copied()) {
        let pairs =
            truth.matched(&estimate.poses, offset_s, (options.association, MOST_COMPARED))?;
        let mut fit = initial(offset_s, options.body, false);
        if align(&mut fit, &pairs, options.alignment).is_ok() {
            let off_m = pairs.iter().map(|pair| {
                let [placed_m, true_m] = fit.both_positions_m(&pair.pose, &pair.truth);
                (true_m - placed_m).norm()
            });
            misfits.extend(median(off_m).map(|misfit_m| (misfit_m, offset_s, pairs.len())));
        }
    }
    let most = misfits.iter().map(|(.., count)| *count).max().unwrap_or_default();
    misfits.retain(|(.., count)| *count as f64 >= LEAST_COMMON * most as f64);
    misfits.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Nothing fits: the check of conventions or of another drive says why.
    let extent_m = extent_m(&estimate.poses);
    if misfits.first().is_none_or(|(misfit_m, ..)| *misfit_m > OTHER_DRIVE * extent_m) {
        return Ok(offset_s);
    }
    match misfits[..] {
        [(best_m, best_s, _), (second_m, second_s, _), ..]
            if second_m < DECISIVE_RATIO * best_m.max(LEAST_MISFIT_M) =>
        {
            let are_apart = best_s.abs().min(second_s.abs()) > FAR_S;
            let why = if are_apart {
                Unfit::NoOverlap
            } else {
                Unfit::AmbiguousOffset { best_s, second_s }
            };
            Err(Unjudged::Unfit { name: estimate.name.clone(), why })
        }
        [(_, best_s, _), ..] => Ok(best_s),
        [] => Ok(offset_s),
    }
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
        clock_change: None,
        lever_arm_m: turning.then(|| match body {
            Body::Lever(lever_m) => lever_m,
            Body::Found | Body::Same => Vector3::zeros(),
        }),
        lever_arm_sigma_m: None,
        covariance: FitCovariance::zeros(),
        body_rotation: None,
        body_rotation_sigma_rad: None,
        estimated_scale: None,
        plane: None,
        findings: Vec::new(),
    }
}

/// Returns an error if the positions fit much better with the inverse of each pose (they are those of the world in the body). The fits
/// ignore the lever arm.
fn refuse_other_conventions(
    truth: &GroundTruth<'_>,
    pairs: &[MatchedPose],
    options: &Options,
) -> Result<(), Unfit> {
    if options.alignment == TrajectoryAlignment::None {
        return Ok(());
    }
    let truth_m: Vec<Vector3<f64>> = pairs.iter().map(|pair| pair.truth.position_m).collect();
    let own_m: Vec<Vector3<f64>> = pairs.iter().map(|pair| pair.pose.position_m).collect();
    let Some(as_read_m) = misfit_m(&truth_m, &own_m) else { return Ok(()) };
    let is_better = |other_m: &f64| as_read_m > OTHER_CONVENTION * other_m;
    let stated = options.convention;
    if stated.inverted == Inverted::Poses {
        return Ok(());
    }
    let of_estimate = [stated.has_w_first, !stated.has_w_first].map(|has_w_first| {
        let convention = Convention { has_w_first, inverted: Inverted::Poses, ..stated };
        let inverse_m: Option<Vec<Vector3<f64>>> = pairs
            .iter()
            .map(|MatchedPose { pose, .. }| {
                let body = convention.orientation(stated.as_written(pose.orientation?));
                Some(-(body * pose.position_m))
            })
            .collect();
        let misfit_m = misfit_m(&truth_m, &inverse_m?).filter(is_better)?;
        let times_better = as_read_m / misfit_m;
        Some((times_better, Unfit::Inverse { times_better, convention }))
    });
    let of_truth = || {
        let inverse_m: Option<Vec<Vector3<f64>>> = pairs
            .iter()
            .map(|MatchedPose { truth, .. }| {
                let orientation = truth.rotation.as_ref()?.orientation;
                Some(-(orientation.inverse() * truth.position_m))
            })
            .collect();
        let times_better = as_read_m / misfit_m(&inverse_m?, &own_m).filter(is_better)?;
        Some((times_better, Unfit::TruthInverse { times_better }))
    };
    let is_trajectory = matches!(truth, GroundTruth::Trajectory(..));
    let of_truth = is_trajectory.then(of_truth).flatten();
    let best =
        of_estimate.into_iter().chain([of_truth]).flatten().max_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or(Ok(()), |(_, why)| Err(why))
}

/// Returns the median distance of positions after an alignment with a scale (m); `None` if they lie on a line.
fn misfit_m(truth_m: &[Vector3<f64>], own_m: &[Vector3<f64>]) -> Option<f64> {
    let (transform, scale) = align_similar(truth_m, own_m)?;
    let off_m = |(truth_m, own_m): (&Vector3<f64>, &Vector3<f64>)| {
        (truth_m - transform.apply(&(own_m * scale))).norm()
    };
    median(truth_m.iter().zip(own_m).map(off_m))
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
