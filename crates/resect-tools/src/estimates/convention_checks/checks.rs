//! Checks of an estimate's conventions before and after its fit, as findings.

use std::sync::Arc;

use super::exchanged::exchanged;
use super::mixed_bodies::mixed_bodies;
use super::orientation_search::{OrientationEvidence, SuspectedOrientation, suspected_orientation};
use super::position_truth::position_truth;
use super::repeated_poses::{held, interpolated, unset};
use super::scale::significant_scale;
use super::time_scale::{suspected_rate, suspected_unit_of_time};
use super::unit_of_length::{SuspectedUnit, compare_shapes, suspected_unit};
use crate::estimates::conventions::{Convention, orientation_in_words};
use crate::estimates::fit::Fit;
use crate::estimates::ground_truth::GroundTruth;
use crate::estimates::matched_pose::MatchedPose;
use crate::estimates::options::{Options, TrajectoryAlignment};
use crate::findings::conventions as findings;
use resect_core::deployment::{EstimatedTrajectory, Finding, Unit};
use resect_core::evaluation::no_trajectory::NoTrajectory;

/// Findings about an estimate before its fit.
#[derive(Clone, Debug, Default)]
pub struct EarlyFindings {
    pub findings: Vec<Finding>,
    /// True if another unit of length or time makes every further number meaningless.
    pub is_other_unit: bool,
}

/// Checks the poses by themselves, then unit and clock against the ground truth.
pub fn before_fit(
    truth: &GroundTruth<'_>,
    estimate: &EstimatedTrajectory,
    options: &Options,
) -> Result<EarlyFindings, NoTrajectory> {
    let (name, poses) = (&*estimate.name, &estimate.poses[..]);
    let mut early = EarlyFindings { findings: of_poses(estimate), is_other_unit: false };
    // Poses that were never set, and those of two bodies, have another shape.
    let has_shape = early.findings.is_empty();
    if let GroundTruth::Trajectory(truth, None) = truth
        && exchanged(estimate, truth)
    {
        early.findings.push(findings::estimate_exchanged(name, &truth.name));
    }
    let Some(positions) = position_truth(truth)? else { return Ok(early) };
    let mut rate = match options.time_offset_s {
        None => suspected_unit_of_time(&positions, poses)?,
        Some(_) => None,
    };
    if rate.is_none() {
        let of_positions = GroundTruth::Trajectory(Arc::clone(&positions), None);
        let shapes = compare_shapes(&of_positions, poses, options.time_offset_s)?;
        if let Some(unit) = shapes.as_ref().and_then(suspected_unit) {
            early.findings.push(unit_finding(name, truth, &unit, &options.convention));
            early.is_other_unit = options.alignment != TrajectoryAlignment::Similarity;
        } else if has_shape && options.time_offset_s.is_none() {
            rate = suspected_rate(&positions, poses, shapes)?;
        }
    }
    if let Some(rate) = rate {
        let misfits = [rate.as_read, Some(rate.with_factor)];
        early.findings.push(findings::estimate_clock_rate(name, rate.factor, rate.unit, misfits));
        early.is_other_unit = rate.excludes_judgement();
    }
    Ok(early)
}

fn unit_finding(
    name: &str,
    truth: &GroundTruth<'_>,
    unit: &SuspectedUnit,
    stated: &Convention,
) -> Finding {
    // The words that are stated already stay.
    let others = Convention { length_m: 1.0, ..*stated }.to_string();
    let with_others = |word: &str| match others.is_empty() {
        true => format!("--convention {word}"),
        false => format!("--convention {others},{word}"),
    };
    let is_trajectory = matches!(truth, GroundTruth::Trajectory(..));
    // A deployment is in metres, so an estimate that is too short was divided by its unit.
    let (owner, unit_name, flag) = match (unit.is_of_truth, unit.word) {
        (false, word) => ("it", unit.name.to_owned(), with_others(word)),
        (true, word) if is_trajectory => {
            ("the ground truth", unit.name.to_owned(), format!("--truth-convention {word}"))
        }
        (true, "mm") => ("it", "kilometres".to_owned(), with_others("km")),
        (true, _) => {
            let quotient = format!("metres divided by the factor of {}", unit.name);
            let word = format!("length={:.4}", unit.times_longer.recip());
            ("it", quotient, with_others(&word))
        }
    };
    findings::estimate_unit(name, unit.times_longer, [owner, &unit_name], &flag)
}

/// Checks the poses by themselves.
fn of_poses(estimate: &EstimatedTrajectory) -> Vec<Finding> {
    let (name, poses) = (&*estimate.name, &estimate.poses[..]);
    let unset = unset(poses).map(|unset| {
        findings::estimate_poses_unset(name, unset.count, unset.jump_m, unset.at_start)
    });
    let repeats = held(poses).map(|poses| {
        findings::estimate_poses_held(name, [poses.different, poses.poses], poses.held_s)
    });
    let interpolated = interpolated(poses).map(|all| {
        let counts = [all.interpolated, all.poses];
        findings::estimate_poses_interpolated(name, counts, all.interval_s)
    });
    let mixed = mixed_bodies(poses).map(|bodies| {
        let steps_m = [bodies.between_m, bodies.within_m];
        findings::estimate_bodies_mixed(name, bodies.poses, steps_m)
    });
    [unset, repeats, interpolated, mixed].into_iter().flatten().collect()
}

/// Checks orientations and scale of an estimate by its fit.
pub fn after_fit(
    estimate: &EstimatedTrajectory,
    pairs: &[MatchedPose],
    fit: &Fit,
    options: &Options,
) -> Vec<Finding> {
    let name = &*estimate.name;
    let suspected = suspected_orientation(&estimate.poses, pairs, fit, &options.convention);
    let orientation = suspected.map(|suspected| orientation_finding(name, &suspected));
    let scale = (options.alignment != TrajectoryAlignment::Similarity)
        .then(|| significant_scale(pairs, fit))
        .flatten()
        .map(|scale| {
            let length_m = options.convention.length_m / (1.0 + scale.value);
            let flag = Convention { length_m, ..options.convention }.to_string();
            findings::estimate_scale_differs(name, &scale, &flag)
        });
    orientation.into_iter().chain(scale).collect()
}

fn orientation_finding(name: &str, suspected: &SuspectedOrientation) -> Finding {
    let flag = |convention: &Convention| match convention.to_string() {
        empty if empty.is_empty() => "xyzw".to_owned(),
        words => words,
    };
    let alternatives: Vec<String> = suspected.alternatives.iter().map(flag).collect();
    let words = orientation_in_words(&suspected.convention);
    let said = [&*words, &*flag(&suspected.convention)];
    let scatter = [suspected.as_read, suspected.with_convention];
    let (subject, unit) = match suspected.evidence {
        OrientationEvidence::Orientations => ("the orientations scatter", Unit::Radian),
        OrientationEvidence::LeverArm => ("the positions with a lever arm scatter", Unit::Metre),
        OrientationEvidence::Travel => {
            ("the direction of travel in the body scatters", Unit::Radian)
        }
    };
    findings::estimate_orientation_convention(name, said, &alternatives, scatter, (subject, unit))
}
