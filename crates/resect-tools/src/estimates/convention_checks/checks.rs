//! Checks of an estimate's conventions before and after its fit, as findings.

use std::sync::Arc;

use super::exchanged::exchanged;
use super::handedness::{SuspectedHandedness, suspected_handedness};
use super::jumps::{bursts_s, jumps};
use super::misread_degrees::misread_degrees;
use super::misread_positions::{MisreadPositions, misread_positions};
use super::mixed_bodies::mixed_bodies;
use super::orientation_delay::orientation_delay_s;
use super::orientation_search::{OrientationEvidence, SuspectedOrientation, suspected_orientation};
use super::position_truth::position_truth;
use super::repeated_poses::{held, interpolated, unset};
use super::scale::significant_scale;
use super::time_scale::{suspected_rate, suspected_unit_of_time};
use super::unit_of_length::{SuspectedUnit, compare_shapes, suspected_unit};
use crate::estimates::conventions::{Convention, is_unset, orientation_in_words};
use crate::estimates::fit::Fit;
use crate::estimates::ground_truth::GroundTruth;
use crate::estimates::matched_pose::MatchedPose;
use crate::estimates::options::{Options, TrajectoryAlignment};
use crate::estimates::trajectory_summary::extent_m;
use crate::findings::conventions as findings;
use crate::findings::kinds;
use resect_core::deployment::{EstimatedPose, EstimatedTrajectory, Finding, Unit};
use resect_core::evaluation::no_trajectory::NoTrajectory;

/// Findings about an estimate before its fit.
#[derive(Clone, Debug, Default)]
pub struct EarlyFindings {
    pub findings: Vec<Finding>,
    /// True if numbers would be meaningless: in another unit, with mirrored axes, or of poses that are torn apart.
    pub excludes_judgement: bool,
}

/// Checks the poses by themselves, then unit and clock against the ground truth.
pub fn before_fit(
    truth: &GroundTruth<'_>,
    estimate: &EstimatedTrajectory,
    options: &Options,
) -> Result<EarlyFindings, NoTrajectory> {
    let (name, poses) = (&*estimate.name, &estimate.poses[..]);
    let mut early = of_poses(estimate, ("--convention", &options.convention));
    // Poses that were never set, and those of two bodies, have another shape.
    let has_shape = early.findings.is_empty();
    if let GroundTruth::Trajectory(truth, None) = truth
        && exchanged(estimate, truth)
    {
        early.findings.push(findings::estimate_exchanged(name, &truth.name));
    }
    let Some(positions) = position_truth(truth)? else { return Ok(early) };
    if options.plane.is_none() && is_planar(poses) && !is_planar(&positions.poses) {
        early.findings.push(findings::estimate_planar(name));
    }
    let mut rate = match options.time_offset_s {
        None => suspected_unit_of_time(&positions, poses)?,
        Some(_) => None,
    };
    if rate.is_none() {
        let of_positions = GroundTruth::Trajectory(Arc::clone(&positions), None);
        let shapes = compare_shapes(&of_positions, poses, options.time_offset_s)?;
        if let Some(unit) = shapes.as_ref().and_then(suspected_unit) {
            early.findings.push(unit_finding(estimate, truth, &unit, &options.convention));
            early.excludes_judgement |= options.alignment != TrajectoryAlignment::Similarity;
        } else if let Some((meaning, is_of_truth)) =
            misread_degrees(&positions, estimate, shapes.as_ref())?
        {
            let file = if is_of_truth { truth.name() } else { name };
            early.findings.push(findings::estimate_degrees(name, file, meaning.in_words()));
            early.excludes_judgement = true;
        } else if let Some(misread) = misread_positions(&of_positions, poses)? {
            early.findings.push(match misread {
                MisreadPositions::Degrees(names) => findings::estimate_geographic(name, names),
                MisreadPositions::Motions => findings::estimate_motions(name),
            });
            early.excludes_judgement = true;
        } else if let Some(shapes) = shapes
            && let Some(suspected) = suspected_handedness(truth, poses, shapes.offset_s, options)?
        {
            early.findings.push(mirrored_finding(name, truth, &suspected));
            early.excludes_judgement = true;
        } else if has_shape && options.time_offset_s.is_none() {
            rate = suspected_rate(&positions, poses, shapes)?;
        }
    }
    if let Some(rate) = rate {
        let misfits = [rate.as_read, Some(rate.with_factor)];
        let time_s = options.convention.time_s * rate.factor;
        let flag = Convention { time_s, ..options.convention }.to_string();
        early.findings.push(findings::estimate_clock_rate(name, rate.factor, &flag, misfits));
        early.excludes_judgement |= rate.excludes_judgement();
    }
    Ok(early)
}

/// Smallest size of a drive in metres; a smaller one is in kilometres.
const SMALLEST_DRIVE_M: f64 = 0.2;

fn unit_finding(
    estimate: &EstimatedTrajectory,
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
    let name = &*estimate.name;
    let is_trajectory = matches!(truth, GroundTruth::Trajectory(..));
    let is_tiny = extent_m(&estimate.poses) < SMALLEST_DRIVE_M;
    // A deployment is in metres, so an estimate that is too short was divided by its unit.
    let (owner, unit_name, flag) = match (unit.is_of_truth, unit.word) {
        (false, word) => ("it", unit.name.to_owned(), with_others(word)),
        (true, "mm") if is_tiny || !is_trajectory => {
            ("it", "kilometres".to_owned(), with_others("km"))
        }
        (true, word) if is_trajectory => {
            ("the ground truth", unit.name.to_owned(), format!("--truth-convention {word}"))
        }
        (true, _) => {
            let quotient = format!("metres divided by the factor of {}", unit.name);
            let word = format!("length={:.4}", unit.times_longer.recip());
            ("it", quotient, with_others(&word))
        }
    };
    findings::estimate_unit(name, unit.times_longer, [owner, &unit_name], &flag)
}

/// A jump of this share of the size of the drive, after which it continues elsewhere, leaves no alignment and no time offset.
const LARGEST_RESET: f64 = 0.5;

/// Adds findings about the poses of a ground truth, which was read with a convention.
pub fn add_findings_of_truth(truth: &mut EstimatedTrajectory, stated: &Convention) {
    let early = of_poses(truth, ("--truth-convention", stated));
    truth.findings.extend(early.findings);
}

/// Checks the poses by themselves; `stated` is the convention with which they were read, by a flag of this name.
fn of_poses(
    estimate: &EstimatedTrajectory,
    (name_of_flag, stated): (&str, &Convention),
) -> EarlyFindings {
    let (name, poses) = (&*estimate.name, &estimate.poses[..]);
    let never_set = unset(poses);
    let unset = never_set.map(|unset| {
        let flag = format!("{name_of_flag} {}", Convention { has_unset_poses: true, ..*stated });
        findings::estimate_poses_unset(name, (unset.count, unset.at_start), unset.jump_m, &flag)
    });
    let repeats = held(poses).map(|poses| {
        let flag = format!("{name_of_flag} {}", Convention { held: Some(poses.part), ..*stated });
        let counts = [poses.different, poses.poses];
        findings::estimate_poses_held(name, poses.part.in_words(), counts, (poses.held_s, &flag))
    });
    let interpolated = interpolated(poses).map(|all| {
        let counts = [all.interpolated, all.poses];
        findings::estimate_poses_interpolated(name, counts, all.interval_s)
    });
    let mixed = mixed_bodies(poses).map(|bodies| {
        let steps_m = [bodies.between_m, bodies.within_m];
        findings::estimate_bodies_mixed(name, bodies.poses, steps_m)
    });
    // Poses that were never set, and those of another body, jump as well.
    let jumps = jumps(poses).filter(|_| unset.is_none() && mixed.is_none());
    let of_jumps = jumps.iter().flat_map(|jumps| {
        let outliers = (jumps.outliers > 0).then(|| {
            let largest = (jumps.outlier_m, jumps.outlier_s);
            findings::estimate_outliers(name, jumps.outliers, largest)
        });
        let resets = (jumps.resets > 0)
            .then(|| findings::estimate_jumps(name, jumps.resets, (jumps.reset_m, jumps.reset_s)));
        [outliers, resets].into_iter().flatten()
    });
    let of_jumps: Vec<Finding> = of_jumps.collect();
    let is_set = |pose: &&EstimatedPose| !is_unset(pose);
    let extent_of_set_m = || extent_m(&poses.iter().filter(is_set).copied().collect::<Vec<_>>());
    let is_torn = never_set.is_some_and(|unset| unset.jump_m > extent_of_set_m())
        || jumps.is_some_and(|jumps| {
            jumps.reset_m > LARGEST_RESET * jumps.extent_m || jumps.outlier_m > jumps.extent_m
        });
    let bursts = bursts_s(poses)
        .filter(|_| mixed.is_none())
        .map(|intervals_s| findings::estimate_bursts(name, intervals_s));
    let all = [unset, repeats, interpolated, mixed, bursts].into_iter().flatten();
    EarlyFindings { findings: all.chain(of_jumps).collect(), excludes_judgement: is_torn }
}

/// Returns true if all heights are equal and the positions are not.
fn is_planar(poses: &[EstimatedPose]) -> bool {
    let Some(first) = poses.first() else { return false };
    let is_level = |pose: &EstimatedPose| pose.position_m.z == first.position_m.z;
    poses.iter().all(is_level) && extent_m(poses) > 0.0
}

/// Checks axes, orientations and scale of an estimate by its fit.
pub fn after_fit(
    truth: &GroundTruth<'_>,
    estimate: &EstimatedTrajectory,
    (pairs, fit): (&[MatchedPose], &Fit),
    options: &Options,
) -> Vec<Finding> {
    let name = &*estimate.name;
    let is_trajectory = matches!(truth, GroundTruth::Trajectory(..));
    let stated = (&options.convention, is_trajectory);
    let suspected = suspected_orientation(&estimate.poses, pairs, fit, stated);
    let orientation = match suspected {
        Some(suspected) => Some(orientation_finding(name, &suspected, options)),
        None => orientation_delay_s(pairs, fit)
            .map(|delay_s| findings::estimate_orientations_late(name, &delay_s)),
    };
    let is_other_scale =
        fit.findings.iter().any(|finding| finding.kind == kinds::ESTIMATE_SCALE_OFF);
    let scale = (options.alignment != TrajectoryAlignment::Similarity && !is_other_scale)
        .then(|| significant_scale(pairs, fit))
        .flatten()
        .map(|scale| {
            let length_m = options.convention.length_m / (1.0 + scale.value);
            let flag = Convention { length_m, ..options.convention }.to_string();
            findings::estimate_scale_differs(name, &scale, &flag)
        });
    orientation.into_iter().chain(scale).collect()
}

fn mirrored_finding(
    name: &str,
    truth: &GroundTruth<'_>,
    suspected: &SuspectedHandedness,
) -> Finding {
    let flag = suspected.convention.to_string();
    let is_trajectory = matches!(truth, GroundTruth::Trajectory(..));
    let of_truth = suspected.of_truth.filter(|_| is_trajectory).map(|word| word.to_string());
    let words = [suspected.words, &flag];
    findings::estimate_mirrored(name, words, suspected.rmse_m, of_truth.as_deref())
}

fn orientation_finding(name: &str, suspected: &SuspectedOrientation, options: &Options) -> Finding {
    let words = |convention: &Convention| match convention.to_string() {
        empty if empty.is_empty() => "xyzw".to_owned(),
        words => words,
    };
    let mut alternatives: Vec<String> = suspected.alternatives.iter().map(words).collect();
    let flag = |convention: &Convention| format!("--convention {}", words(convention));
    let of_truth = |convention: &Convention| format!("--truth-convention {}", words(convention));
    let (subject, flag) = match &suspected.of_truth {
        // Relative to the convention of the estimate as it is.
        Some(truth) if suspected.convention == options.convention => {
            (format!("with the ground truth {}", orientation_in_words(truth)), of_truth(truth))
        }
        truth => {
            alternatives.extend(truth.iter().map(of_truth));
            (orientation_in_words(&suspected.convention), flag(&suspected.convention))
        }
    };
    let scatter = [suspected.as_read, suspected.with_convention];
    let (evidence, unit) = match suspected.evidence {
        OrientationEvidence::Orientations => ("the orientations scatter", Unit::Radian),
        OrientationEvidence::LeverArm => ("the positions with a lever arm scatter", Unit::Metre),
        OrientationEvidence::Travel => {
            ("the direction of travel in the body scatters", Unit::Radian)
        }
    };
    let said = [&*subject, &*flag];
    findings::estimate_orientation_convention(name, said, &alternatives, scatter, (evidence, unit))
}
