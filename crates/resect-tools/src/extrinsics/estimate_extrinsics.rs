//! The estimate: pose of b in a, clock and scale by the whole drive and by its halves, and the verdict.

use std::sync::Arc;

use nalgebra::{Rotation3, UnitQuaternion};

use super::advised_motion::{AdvisedMotion, advised_motions};
use super::driven_motion::{DrivenMotion, driven_motion};
use super::errors::NoExtrinsics;
use super::halves::{HalvesOutcome, MOST_SIGMAS, differences};
use super::lever_direction::{LeverDirection, lever_directions};
use super::solution::{GOOD_LEVER_M, GOOD_ROTATION_RAD, GOOD_TIME_S, Solution};
use crate::estimates::conventions::Convention;
use crate::estimates::fit::Fit;
use crate::estimates::{
    ConventionalFit, EstimatedPose, EstimatedTrajectory, GroundTruth, Options, TrajectoryAlignment,
    fit_with_convention,
};
use resect_core::calibration::{Estimate, Verdict};
use resect_core::deployment::Finding;
use resect_core::geometry::RigidTransform;

/// Extrinsic calibration of body a, and of b, which is a body or an antenna.
#[derive(Clone, Debug, PartialEq)]
pub struct Extrinsics {
    /// Names of both trajectories, which are those of the frames.
    pub names: [String; 2],
    /// Number of poses of both, and of the pairs that were compared.
    pub poses: [usize; 2],
    pub pairs: usize,
    pub solution: Solution,
    /// Directions of the lever arm in a, the least determined first; empty if it was given.
    pub directions: Vec<LeverDirection>,
    pub motion: DrivenMotion,
    pub halves: HalvesOutcome,
    /// Time offset by the drive (s) that contradicts the given one.
    pub other_offset_s: Option<Estimate>,
    pub verdict: Verdict,
    /// Motions that would determine more.
    pub advice: Vec<AdvisedMotion>,
    pub findings: Vec<Finding>,
}

/// Estimates the pose of b in a. `options` are those of the comparison of b with a; `convention_of_a` is that of a's file.
///
/// # Errors
/// If a has no orientations, if both are the same trajectory, or if the trajectories do not fit each other.
pub fn estimate_extrinsics(
    [mut a, mut b]: [EstimatedTrajectory; 2],
    options: &Options,
    convention_of_a: Convention,
) -> Result<Extrinsics, NoExtrinsics> {
    let names = [a.name.clone(), b.name.clone()];
    let [of_a, of_b] = names.clone();
    if a.is_same(&b) || a.poses == b.poses {
        return Err(NoExtrinsics::Same(of_a, of_b));
    }
    match [a.has_orientations(), b.has_orientations()] {
        [false, true] => return Err(NoExtrinsics::Exchanged { a: of_a, b: of_b }),
        [false, false] => return Err(NoExtrinsics::NoOrientations { a: of_a, b: of_b }),
        _ => {}
    }
    convention_of_a.apply(&mut a);
    options.convention.apply(&mut b);
    let options = Options { convention: Convention::AS_READ, ..*options };
    let (fit, pairs) = fitted(&a, &b, &options)?;
    let solution = solution_of(&fit, b.has_orientations());
    let orientations: Vec<UnitQuaternion<f64>> =
        a.poses.iter().filter_map(|pose| pose.orientation).collect();
    let directions = solution
        .lever_covariance_m2
        .map(|covariance_m2| lever_directions(&covariance_m2, &orientations).to_vec())
        .unwrap_or_default();
    let halves = compare_halves([&a, &b], &options, solution.time_offset_s);
    let motion = driven_motion(&a.poses);
    let other_offset_s = options
        .time_offset_s
        .and_then(|given_s| contradicting_offset_s([&a, &b], &options, given_s));
    let verdict = match other_offset_s {
        Some(_) => Verdict::Ambiguous,
        None => verdict(&solution, &directions, &halves),
    };
    Ok(Extrinsics {
        poses: [a.poses.len(), b.poses.len()],
        pairs,
        verdict,
        advice: advised_motions(&solution, &directions, &motion),
        findings: a.findings.into_iter().chain(b.findings).chain(fit.findings).collect(),
        names,
        solution,
        directions,
        motion,
        halves,
        other_offset_s,
    })
}

/// Returns the time offset by the drive if a given one contradicts it, as halves would contradict each other.
fn contradicting_offset_s(
    [a, b]: [&EstimatedTrajectory; 2],
    options: &Options,
    given_s: f64,
) -> Option<Estimate> {
    let options = Options { time_offset_s: None, near_offset_s: Some(given_s), ..*options };
    let (fit, _) = fitted(a, b, &options).ok()?;
    let solution = solution_of(&fit, b.has_orientations());
    let (value, sigma) = (solution.time_offset_s, solution.time_offset_sigma_s?);
    let is_other = (value - given_s).abs() > MOST_SIGMAS * sigma;
    is_other.then_some(Estimate { value, sigma })
}

/// Estimates the pose of an estimate's body in that of a ground truth, with the options of their comparison. A ground truth of positions is
/// an antenna or a prism on the estimate's body.
///
/// # Errors
/// As [`estimate_extrinsics`].
pub fn extrinsics_with_truth(
    truth: &EstimatedTrajectory,
    estimate: &EstimatedTrajectory,
    options: &Options,
) -> Result<Extrinsics, NoExtrinsics> {
    // Alignment decides only if the scale is free: the frames wander.
    let alignment = match options.alignment {
        TrajectoryAlignment::Similarity => TrajectoryAlignment::Similarity,
        _ => TrajectoryAlignment::Rigid,
    };
    let usual = Options { alignment, ..Options::default() };
    if truth.has_orientations() || !estimate.has_orientations() {
        let Options { time_offset_s, convention, .. } = *options;
        let options = Options { time_offset_s, convention, ..usual };
        return estimate_extrinsics(
            [truth.clone(), estimate.clone()],
            &options,
            Convention::AS_READ,
        );
    }
    let time_offset_s = options.time_offset_s.map(|offset_s| -offset_s);
    let exchanged = Options { time_offset_s, ..usual };
    estimate_extrinsics([estimate.clone(), truth.clone()], &exchanged, options.convention)
}

/// Returns the fit of both, and the number of compared pairs. Positions without orientation are the ground truth of a's poses.
fn fitted(
    a: &EstimatedTrajectory,
    b: &EstimatedTrajectory,
    options: &Options,
) -> Result<(Fit, usize), NoExtrinsics> {
    let has_orientations = b.has_orientations();
    let (truth, estimate) = if has_orientations { (a, b) } else { (b, a) };
    let truth = GroundTruth::Trajectory(Arc::new(truth.clone()), None);
    // Offsets are added to b's times here, and to the estimate's there.
    let of_estimate = |offset_s: f64| if has_orientations { offset_s } else { -offset_s };
    let options = Options {
        time_offset_s: options.time_offset_s.map(of_estimate),
        near_offset_s: options.near_offset_s.map(of_estimate),
        ..*options
    };
    let ConventionalFit { fit, matched, .. } =
        fit_with_convention(&truth, &mut estimate.clone(), &options)?;
    Ok((fit, matched.len()))
}

fn solution_of(fit: &Fit, has_orientations: bool) -> Solution {
    let rotation = match fit.body_rotation.filter(|_| has_orientations) {
        Some(rotation) => rotation.to_rotation_matrix(),
        None => Rotation3::identity(),
    };
    let translation_m = fit.lever_arm_m.unwrap_or_default();
    // The factor applies to the estimate, which is b if that has orientations, and a otherwise.
    let scale = fit.estimated_scale.map(|scale| match has_orientations {
        true => scale,
        false => Estimate { value: 1.0 / scale.value, sigma: scale.sigma / scale.value.powi(2) },
    });
    Solution {
        a_from_b: RigidTransform { rotation, translation_m },
        lever_sigma_m: fit.lever_arm_sigma_m,
        lever_covariance_m2: fit.lever_arm_covariance_m2(),
        determines_lever: std::array::from_fn(|axis| fit.determines_lever_arm(axis)),
        rotation_sigma_rad: fit.body_rotation_sigma_rad.filter(|_| has_orientations),
        time_offset_s: if has_orientations { fit.time_offset_s } else { -fit.time_offset_s },
        time_offset_sigma_s: fit.time_offset_sigma_s,
        scale,
    }
}

/// Fits both halves of the common time by themselves.
fn compare_halves(
    [a, b]: [&EstimatedTrajectory; 2],
    options: &Options,
    time_offset_s: f64,
) -> HalvesOutcome {
    let span_s = |poses: &[EstimatedPose], by_s: f64| {
        let [from_s, to_s] = [poses.first(), poses.last()].map(|pose| pose.map(|it| it.time_s));
        [from_s.unwrap_or_default() + by_s, to_s.unwrap_or_default() + by_s]
    };
    let [of_a, of_b] = [span_s(&a.poses, 0.0), span_s(&b.poses, time_offset_s)];
    let middle_s = 0.5 * (of_a[0].max(of_b[0]) + of_a[1].min(of_b[1]));
    let half_of_a = |is_first: bool| {
        let mut half = a.clone();
        half.poses.retain(|pose| (pose.time_s < middle_s) == is_first);
        if half.covariances.len() == a.poses.len() {
            let in_half = a.poses.iter().map(|pose| (pose.time_s < middle_s) == is_first);
            let both = a.covariances.iter().zip(in_half);
            half.covariances = both.filter(|(_, is_in)| *is_in).map(|(one, _)| *one).collect();
        }
        half
    };
    let options = Options { near_offset_s: Some(time_offset_s), ..*options };
    let solved = |is_first: bool| {
        let (fit, _) = fitted(&half_of_a(is_first), b, &options)?;
        Ok(solution_of(&fit, b.has_orientations()))
    };
    let both: Result<Vec<Solution>, NoExtrinsics> = [true, false].into_iter().map(solved).collect();
    match both.map(<[Solution; 2]>::try_from) {
        Ok(Ok(both)) => HalvesOutcome::Compared(differences(&both)),
        Ok(Err(_)) => HalvesOutcome::Compared(Vec::new()),
        Err(why) => HalvesOutcome::NoAnswer(why.to_string()),
    }
}

/// A contradiction comes first: it makes each σ doubtful, that of an undetermined direction too.
fn verdict(solution: &Solution, directions: &[LeverDirection], halves: &HalvesOutcome) -> Verdict {
    if halves.contradiction().is_some() {
        return Verdict::Ambiguous;
    }
    if directions.iter().any(|direction| !direction.is_determined()) {
        return Verdict::Degenerate;
    }
    match weakness(solution, directions).is_some() || matches!(halves, HalvesOutcome::NoAnswer(_)) {
        true => Verdict::Weak,
        false => Verdict::Good,
    }
}

/// Number whose σ is larger than that of a good calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weakness {
    Lever(LeverDirection),
    /// σ (rad).
    Rotation(f64),
    /// σ (s).
    TimeOffset(f64),
}

/// Returns the first number that is weak: lever arm, rotation, time offset.
pub fn weakness(solution: &Solution, directions: &[LeverDirection]) -> Option<Weakness> {
    let lever = directions.first().filter(|direction| direction.sigma_m > GOOD_LEVER_M);
    let rotation = solution.rotation_sigma_rad.map(|sigma| sigma.max());
    let clock = solution.time_offset_sigma_s;
    lever
        .map(|direction| Weakness::Lever(*direction))
        .or(rotation.filter(|sigma| *sigma > GOOD_ROTATION_RAD).map(Weakness::Rotation))
        .or(clock.filter(|sigma_s| *sigma_s > GOOD_TIME_S).map(Weakness::TimeOffset))
}
