//! Poses that repeat others: held until the next, interpolated between others, or never set.

use super::rounding::rounding_step_m;
use crate::estimates::conventions::{HeldPart, is_unset};
use resect_core::deployment::EstimatedPose;
use resect_core::statistics::median;

/// Poses are held if at least this share of the different ones repeats at the next stamps. Slower poses at a faster rate repeat
/// all of them; a standstill repeats one pose many times.
const HELD_SHARE: f64 = 0.25;
/// Fewest different poses by which holding or interpolation is recognised.
const FEWEST: usize = 20;

/// Least share of repeats of positions or orientations alone, and the least steps between different ones (rounding steps, rad): rounded poses
/// of a slow drive repeat as well, and orientations of a straight one.
const HELD_PART_SHARE: f64 = 0.5;
const LEAST_STEPS: f64 = 20.0;
const LEAST_TURN_RAD: f64 = 2e-3;

/// Poses of which a part is held until the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldPoses {
    pub part: HeldPart,
    pub poses: usize,
    pub different: usize,
    /// Median time for which the part is held (s).
    pub held_s: f64,
}

/// Returns the size of repeated poses, positions or orientations; `None` if nothing is held.
pub fn held(poses: &[EstimatedPose]) -> Option<HeldPoses> {
    held_part(poses, HeldPart::Pose, HELD_SHARE).or_else(|| {
        let step_m = |two: &[EstimatedPose]| (two[1].position_m - two[0].position_m).norm();
        let turn_rad = |two: &[EstimatedPose]| {
            two[0].orientation.zip(two[1].orientation).map_or(0.0, |(a, b)| a.angle_to(&b))
        };
        // Most steps of a held part are zero, so the mean of the others counts.
        let mean_of_changes = |steps: Vec<f64>| {
            let changes: Vec<f64> = steps.into_iter().filter(|step| *step > 0.0).collect();
            changes.iter().sum::<f64>() / changes.len().max(1) as f64
        };
        let moves = mean_of_changes(poses.windows(2).map(step_m).collect())
            > LEAST_STEPS * rounding_step_m(poses);
        let turns = mean_of_changes(poses.windows(2).map(turn_rad).collect()) > LEAST_TURN_RAD;
        let of_positions = moves.then(|| held_part(poses, HeldPart::Position, HELD_PART_SHARE));
        let of_orientations =
            || turns.then(|| held_part(poses, HeldPart::Orientation, HELD_PART_SHARE)).flatten();
        of_positions.flatten().or_else(of_orientations)
    })
}

fn held_part(poses: &[EstimatedPose], part: HeldPart, share: f64) -> Option<HeldPoses> {
    let runs: Vec<&[EstimatedPose]> =
        poses.chunk_by(|before, pose| part.is_repeat(before, pose)).collect();
    let repeated: Vec<&[EstimatedPose]> =
        runs.iter().copied().filter(|run| run.len() > 1).collect();
    if runs.len() < FEWEST || (repeated.len() as f64) < share * runs.len() as f64 {
        return None;
    }
    let starts_s = runs.iter().map(|run| run[0].time_s);
    let held_s = median(starts_s.clone().skip(1).zip(starts_s).map(|(next, start)| next - start))?;
    Some(HeldPoses { part, poses: poses.len(), different: runs.len(), held_s })
}

/// Poses on straight lines between others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InterpolatedPoses {
    pub poses: usize,
    pub interpolated: usize,
    /// Median time between the poses that are not interpolated (s).
    pub interval_s: f64,
}

/// Bends are those of interpolated poses if this share of them stands alone or in pairs, between straight lines.
const LONE_BENDS: f64 = 0.8;
/// Least share of poses on lines, of those that move.
const LEAST_ON_LINE: f64 = 0.45;

/// Returns the size of a linear interpolation; `None` if the poses are not interpolated.
///
/// The bends of a measured trajectory follow each other; those of an interpolated one stand alone, because all poses between
/// two measured ones lie on a line at even steps.
pub fn interpolated(poses: &[EstimatedPose]) -> Option<InterpolatedPoses> {
    MEASURED.iter().find_map(|shares| interpolated_with(poses, *shares))
}

/// Least share of the poses that are measured, for few and for many interpolated ones between two of them. A pose is on the line between its
/// neighbours if it is off by less than the second share of the usual bend at the measured ones.
/// Effect: a larger second share takes the noise between loop closures for interpolation.
const MEASURED: [(f64, f64); 2] = [(0.025, 0.02), (0.0025, 0.002)];

fn interpolated_with(
    poses: &[EstimatedPose],
    (measured, on_line): (f64, f64),
) -> Option<InterpolatedPoses> {
    let moves = |index: &usize| poses[*index].position_m != poses[index - 1].position_m;
    let moving: Vec<usize> = (1..poses.len().saturating_sub(1)).filter(moves).collect();
    let bends_m: Vec<f64> =
        moving.iter().map(|index| bend_m(&poses[index - 1..=index + 1])).collect();
    let mut sorted_m = bends_m.clone();
    sorted_m.sort_by(f64::total_cmp);
    let measured = (measured * sorted_m.len() as f64) as usize;
    let usual_m = sorted_m.get(sorted_m.len().checked_sub(1 + measured)?)?;
    let is_bent: Vec<bool> = bends_m.iter().map(|bend_m| *bend_m > on_line * usual_m).collect();
    let bent = is_bent.iter().filter(|is_bent| **is_bent).count();
    let on_line = is_bent.len() - bent;
    let in_short_runs: usize = is_bent
        .chunk_by(|a, b| a == b)
        .filter(|run| run[0] && run.len() <= 2)
        .map(<[bool]>::len)
        .sum();
    let is_interpolated = bent >= FEWEST
        && on_line as f64 >= LEAST_ON_LINE * is_bent.len() as f64
        && in_short_runs as f64 >= LONE_BENDS * bent as f64;
    if !is_interpolated {
        return None;
    }
    let runs = is_bent.chunk_by(|a, b| a == b).filter(|run| run[0]).count();
    let span_s: f64 =
        moving.iter().map(|index| poses[*index].time_s - poses[index - 1].time_s).sum();
    Some(InterpolatedPoses {
        poses: is_bent.len(),
        interpolated: on_line,
        interval_s: span_s / runs as f64,
    })
}

/// Distance of the second of three poses from the line through the others at its time (m).
fn bend_m(three: &[EstimatedPose]) -> f64 {
    let share = (three[1].time_s - three[0].time_s) / (three[2].time_s - three[0].time_s);
    (three[1].position_m - three[0].position_m.lerp(&three[2].position_m, share)).norm()
}

/// Poses that were never set, and the jump beside them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnsetPoses {
    pub count: usize,
    pub jump_m: f64,
    /// True if all of them precede the others.
    pub at_start: bool,
}

/// A pose at the origin was never set if the next one is farther away than this multiple of the longest usual step (99 %), and
/// than this distance (m). A trajectory may well begin at the origin.
const JUMP_STEPS: f64 = 5.0;
const SHORTEST_JUMP_M: f64 = 0.3;

/// Returns the poses that were never set; `None` without any.
pub fn unset(poses: &[EstimatedPose]) -> Option<UnsetPoses> {
    let runs: Vec<&[EstimatedPose]> = poses.chunk_by(|a, b| is_unset(a) == is_unset(b)).collect();
    let set = || runs.iter().filter(|run| !is_unset(&run[0]));
    let step_m = |pair: &[EstimatedPose]| (pair[1].position_m - pair[0].position_m).norm();
    let mut steps_m: Vec<f64> = set().flat_map(|run| run.windows(2).map(step_m)).collect();
    steps_m.sort_by(f64::total_cmp);
    let usual_m = steps_m.get(99 * steps_m.len() / 100)?;
    let limit_m = (JUMP_STEPS * usual_m).max(SHORTEST_JUMP_M);
    // A pose of zeros is at the origin, so the distance of its neighbours is the jump.
    let jump_m = |run: usize| {
        let before = run.checked_sub(1).and_then(|before| runs[before].last());
        let after = runs.get(run + 1).and_then(|after| after.first());
        let distances_m = [before, after].into_iter().flatten().map(|pose| pose.position_m.norm());
        distances_m.fold(f64::INFINITY, f64::min)
    };
    let jumps: Vec<(usize, f64)> = (0..runs.len())
        .filter(|run| is_unset(&runs[*run][0]))
        .map(|run| (run, jump_m(run)))
        .filter(|(_, jump_m)| jump_m.is_finite() && *jump_m > limit_m)
        .collect();
    let count = jumps.iter().map(|(run, _)| runs[*run].len()).sum();
    let jump_m = jumps.iter().map(|(_, jump_m)| *jump_m).fold(0.0, f64::max);
    (count > 0).then_some(UnsetPoses {
        count,
        jump_m,
        at_start: jumps.iter().all(|(run, _)| *run == 0),
    })
}
