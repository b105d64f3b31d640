//! Normal equations of the fit, with the errors of an estimate in segments of time that have noise and a common error each.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::state::{CLOCK, FitState, LEVER, SCALE, TRANSLATION, UNKNOWNS};
use crate::estimates::matched_pose::{MatchedPose, TruePose};
use resect_core::calibration::joint::prism_motion::ConstantsJacobian;
use resect_core::statistics::robust::huber;
use resect_core::statistics::{median, sandwich};

/// Errors are assumed to be independent between blocks: number of blocks, and the shortest one (s).
pub const BLOCKS: f64 = 24.0;
pub const SHORTEST_BLOCK_S: f64 = 2.0;
/// Length of a segment (s), within which an estimate hardly drifts.
const PIECE_S: f64 = 3.0;
/// Threshold of Huber's loss (σ), and the median length of a vector of three errors over their σ.
const BEND: f64 = 2.0;
const MEDIAN_LENGTH: f64 = 1.538;
/// Smallest number of differences within segments that determines the noise.
const FEWEST_WITHIN: usize = 20;

/// An error (m), and its derivative with respect to each unknown.
type Row = (Vector3<f64>, [Vector3<f64>; UNKNOWNS]);

/// Segments of the drive with a common error each (a random effect), because errors of an estimate are noise about a drift.
/// Differences within a segment are weighted by the noise, the segment's mean by the size of the means.
pub struct Pieces<'a> {
    all: Vec<EpochGroup<'a>>,
    /// Number of blocks of time.
    blocks: usize,
    /// One standard deviation of the errors within segments, and of the means, along an axis (m).
    noise_m: f64,
    drift_m: f64,
}

/// Epochs of one segment, which have a common error.
struct EpochGroup<'a> {
    block: usize,
    truths: Vec<&'a TruePose>,
    mean: Row,
    /// The rows minus their mean.
    within: Vec<Row>,
}

impl<'a> Pieces<'a> {
    pub fn of(pairs: &'a [MatchedPose], state: &FitState) -> Self {
        let (from_s, to_s) = (pairs[0].truth.time_s, pairs[pairs.len() - 1].truth.time_s);
        let block_s = ((to_s - from_s) / BLOCKS).max(SHORTEST_BLOCK_S);
        let piece_s = block_s / (block_s / PIECE_S).ceil();
        let place = |truth: &TruePose, length_s: f64| ((truth.time_s - from_s) / length_s) as usize;
        let all: Vec<EpochGroup<'a>> = pairs
            .chunk_by(|a, b| place(&a.truth, piece_s) == place(&b.truth, piece_s))
            .map(|pairs| EpochGroup {
                block: place(&pairs[0].truth, block_s),
                truths: pairs.iter().map(|pair| &pair.truth).collect(),
                ..EpochGroup::of(pairs.iter().map(|pair| row(pair, state)).collect())
            })
            .collect();
        let axis_sigma_m = |lengths: &mut dyn Iterator<Item = f64>| {
            (median(lengths).unwrap_or(1.0) / MEDIAN_LENGTH).max(1e-9)
        };
        let drift_m = axis_sigma_m(&mut all.iter().map(|piece| piece.mean.0.norm()));
        let several = all.iter().filter(|piece| piece.within.len() > 1);
        let within_m: Vec<f64> =
            several.flat_map(|piece| piece.within.iter().map(|row| row.0.norm())).collect();
        // Few differences within segments do not determine the noise. Surveyed points are single in their segments.
        let noise_m = if within_m.len() < FEWEST_WITHIN {
            drift_m
        } else {
            axis_sigma_m(&mut within_m.into_iter())
        };
        Self { all, blocks: ((to_s - from_s) / block_s) as usize + 1, noise_m, drift_m }
    }

    /// Information matrix and gradient of each block of time, with the errors weighted by their σ.
    pub fn blocks(&self, open: &[usize]) -> Vec<sandwich::Block> {
        let mut blocks: Vec<sandwich::Block> = (0..self.blocks)
            .map(|_| sandwich::Block {
                information: DMatrix::zeros(open.len(), open.len()),
                gradient: DVector::zeros(open.len()),
            })
            .collect();
        for piece in &self.all {
            let block = &mut blocks[piece.block];
            for (row, sigma_m) in self.rows(piece) {
                let (error, design) = row;
                let weight = weight(row, sigma_m);
                for (i, a) in open.iter().enumerate() {
                    block.gradient[i] -= weight * design[*a].dot(error);
                    for (j, b) in open.iter().enumerate() {
                        block.information[(i, j)] += weight * design[*a].dot(&design[*b]);
                    }
                }
            }
        }
        blocks.retain(|block| block.information.norm() > 0.0);
        blocks
    }

    /// Rows minus the mean of their segment, then the mean, each with its σ (m).
    fn rows<'b>(&self, piece: &'b EpochGroup<'a>) -> impl Iterator<Item = (&'b Row, f64)> {
        let (noise_m, drift_m) = (self.noise_m, self.drift_m);
        let within = piece.within.iter().map(move |row| (row, noise_m));
        within.chain([(&piece.mean, drift_m)])
    }
}

fn weight((error, _): &Row, sigma_m: f64) -> f64 {
    huber(error.norm() / sigma_m, BEND).weight / (sigma_m * sigma_m)
}

/// Jacobian of the gradient with respect to the errors of the ground truth that are common to all instants.
pub fn by_common(
    pieces: &Pieces<'_>,
    open: &[usize],
    state: &FitState,
    common: &ConstantsJacobian,
) -> DMatrix<f64> {
    let constants = common.covariance.nrows();
    let mut moved = DMatrix::zeros(open.len(), constants);
    let mut left = common.instants.iter().peekable();
    for piece in &pieces.all {
        // The true position of the body depends on the vehicle's position, and by the lever arm on its rotation.
        let each: Vec<DMatrix<f64>> = piece
            .truths
            .iter()
            .map(|truth| {
                while left.next_if(|(time_s, _)| *time_s < truth.time_s).is_some() {}
                let Some((_, by)) = left.next_if(|(time_s, _)| *time_s == truth.time_s) else {
                    return DMatrix::zeros(3, constants);
                };
                let mut body = by.rows(0, 3).into_owned();
                if let (Some(rotation), Some(lever_m)) = (&truth.rotation, state.fit.lever_arm_m) {
                    let by_turn = -(rotation.orientation * lever_m).cross_matrix();
                    body += by_turn * by.rows(3, 3);
                }
                body
            })
            .collect();
        let share = 1.0 / each.len() as f64;
        let mean = each.iter().fold(DMatrix::zeros(3, constants), |sum, one| sum + one * share);
        let within = each.iter().map(|one| one - &mean).collect::<Vec<_>>();
        for ((row, sigma_m), by) in pieces.rows(piece).zip(within.iter().chain([&mean])) {
            let weight = weight(row, sigma_m);
            for (i, unknown) in open.iter().enumerate() {
                let of_unknown = (row.1[*unknown].transpose() * weight) * by;
                let mut sum = moved.row_mut(i);
                sum -= of_unknown;
            }
        }
    }
    moved
}

impl EpochGroup<'_> {
    fn of(mut rows: Vec<Row>) -> Self {
        let share = 1.0 / rows.len() as f64;
        let mut mean = (Vector3::zeros(), [Vector3::zeros(); UNKNOWNS]);
        for (error, design) in &rows {
            mean.0 += share * error;
            mean.1.iter_mut().zip(design).for_each(|(sum, column)| *sum += share * column);
        }
        for (error, design) in &mut rows {
            *error -= mean.0;
            design.iter_mut().zip(&mean.1).for_each(|(column, mean)| *column -= mean);
        }
        Self { block: 0, truths: Vec::new(), mean, within: rows }
    }
}

/// Truth minus estimate (m), and its derivative with respect to each unknown.
fn row(MatchedPose { pose, truth, pose_twist }: &MatchedPose, state: &FitState) -> Row {
    let fit = &state.fit;
    let [placed_m, mut true_m] = fit.both_positions_m(pose, truth);
    let mut velocity = truth.velocity_m_per_s;
    let mut lever_axes = Matrix3::zeros();
    let own = fit.placed_orientation(pose);
    if let Some(rotation) = &truth.rotation {
        lever_axes = rotation.orientation.to_rotation_matrix().into_inner();
        velocity += rotation.rate_rad_per_s.cross(&(true_m - truth.position_m));
    } else if let Some(own) = own {
        lever_axes = -own.to_rotation_matrix().into_inner();
    }
    if let Some(twist) = pose_twist {
        // The estimate is interpolated: a later ground truth is an earlier estimate.
        let arm_m = own.map_or(Vector3::zeros(), |own| own * fit.lever_arm_m.unwrap_or_default());
        let rate = fit.truth_from_estimate.rotate(&twist.rate_rad_per_s);
        velocity = fit.truth_from_estimate.rotate(&(fit.scale * twist.velocity_m_per_s));
        if truth.rotation.is_none() {
            velocity += rate.cross(&arm_m);
        }
    }
    true_m += velocity * state.later_s;
    let pivot_m = fit.truth_from_estimate.apply(&(fit.scale * state.pivot_m));
    let mut design = [Vector3::zeros(); UNKNOWNS];
    for axis in 0..3 {
        let unit = Vector3::ith(axis, 1.0);
        design[axis] = -unit.cross(&(placed_m - pivot_m));
        design[TRANSLATION + axis] = -unit;
        design[LEVER + axis] = lever_axes.column(axis).into_owned();
    }
    let from_pivot_m = pose.position_m - state.pivot_m;
    design[SCALE] = -fit.truth_from_estimate.rotate(&(fit.scale * from_pivot_m));
    design[CLOCK] = velocity;
    (true_m - placed_m, design)
}
