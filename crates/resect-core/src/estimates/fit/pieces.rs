//! What an estimate's errors say of the unknowns: cut into pieces of time, each with noise and an error in common.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::state::{CLOCK, LEVER, SCALE, State, TRANSLATION, UNKNOWNS};
use crate::calibration::joint::prisms::ByConstants;
use crate::estimates::estimate::EstimatedPose;
use crate::estimates::reference::True;
use crate::statistics::robust::huber;
use crate::statistics::{median, sandwich};

/// Errors are taken to forget each other within a block: so many blocks, none shorter than this (s).
pub const BLOCKS: f64 = 24.0;
pub const SHORTEST_BLOCK_S: f64 = 2.0;
/// Within such a time an estimate hardly drifts (s).
const PIECE_S: f64 = 3.0;
/// Huber's bend (σ), and the median length of an error of three axes over their σ.
const BEND: f64 = 2.0;
const MEDIAN_LENGTH: f64 = 1.538;

/// An error (m), and how it changes with each unknown.
type Row = (Vector3<f64>, [Vector3<f64>; UNKNOWNS]);

/// Errors of an estimate are noise about a drift, so the drive is cut into pieces with a common error each (a random effect):
/// what differs within a piece counts by the noise, the piece's mean by how large the means are.
pub struct Pieces<'a> {
    all: Vec<Piece<'a>>,
    /// How many blocks of time they are in.
    blocks: usize,
    /// One standard deviation of the errors within pieces, and of the means, along an axis (m).
    noise_m: f64,
    drift_m: f64,
}

/// Epochs that have a part of their error in common.
struct Piece<'a> {
    block: usize,
    truths: Vec<&'a True>,
    mean: Row,
    /// The rows less their mean.
    within: Vec<Row>,
}

impl<'a> Pieces<'a> {
    pub fn of(pairs: &[(&EstimatedPose, &'a True)], state: &State) -> Self {
        let (from_s, to_s) = (pairs[0].1.time_s, pairs[pairs.len() - 1].1.time_s);
        let block_s = ((to_s - from_s) / BLOCKS).max(SHORTEST_BLOCK_S);
        let piece_s = block_s / (block_s / PIECE_S).ceil();
        let place = |truth: &True, length_s: f64| ((truth.time_s - from_s) / length_s) as usize;
        let all: Vec<Piece<'a>> = pairs
            .chunk_by(|a, b| place(a.1, piece_s) == place(b.1, piece_s))
            .map(|pairs| Piece {
                block: place(pairs[0].1, block_s),
                truths: pairs.iter().map(|(_, truth)| *truth).collect(),
                ..Piece::of(pairs.iter().map(|(pose, truth)| row(pose, truth, state)).collect())
            })
            .collect();
        let axis_sigma_m = |lengths: &mut dyn Iterator<Item = f64>| {
            (median(lengths).unwrap_or(1.0) / MEDIAN_LENGTH).max(1e-9)
        };
        let noise_m =
            axis_sigma_m(&mut all.iter().flat_map(|p| p.within.iter().map(|row| row.0.norm())));
        let drift_m = axis_sigma_m(&mut all.iter().map(|piece| piece.mean.0.norm()));
        Self { all, blocks: ((to_s - from_s) / block_s) as usize + 1, noise_m, drift_m }
    }

    /// What each block of time says, in units of the errors' own σ.
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

    /// What differs within a piece, and last its mean, each with its σ (m).
    fn rows<'b>(&self, piece: &'b Piece<'a>) -> impl Iterator<Item = (&'b Row, f64)> {
        let (noise_m, drift_m) = (self.noise_m, self.drift_m);
        let within = piece.within.iter().map(move |row| (row, noise_m));
        within.chain([(&piece.mean, drift_m)])
    }
}

fn weight((error, _): &Row, sigma_m: f64) -> f64 {
    huber(error.norm() / sigma_m, BEND).weight / (sigma_m * sigma_m)
}

/// How the gradient moves with what errors of the ground truth all instants have in common.
pub fn by_common(
    pieces: &Pieces<'_>,
    open: &[usize],
    state: &State,
    common: &ByConstants,
) -> DMatrix<f64> {
    let constants = common.covariance.nrows();
    let mut moved = DMatrix::zeros(open.len(), constants);
    let mut left = common.each.iter().peekable();
    for piece in &pieces.all {
        // The truth at the body moves with the vehicle's position, and with its turns by the lever arm.
        let each: Vec<DMatrix<f64>> = piece
            .truths
            .iter()
            .map(|truth| {
                while left.next_if(|(time_s, _)| *time_s < truth.time_s).is_some() {}
                let Some((_, by)) = left.next_if(|(time_s, _)| *time_s == truth.time_s) else {
                    return DMatrix::zeros(3, constants);
                };
                let mut body = by.rows(0, 3).into_owned();
                if let (Some(turned), Some(lever_m)) = (&truth.turned, state.fit.lever_arm_m) {
                    let by_turn = -(turned.orientation * lever_m).cross_matrix();
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

impl Piece<'_> {
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

/// Truth less estimate (m), and how it changes with each unknown.
fn row(pose: &EstimatedPose, truth: &True, state: &State) -> Row {
    let fit = &state.fit;
    let [placed_m, mut true_m] = fit.both_positions_m(pose, truth);
    let mut velocity = truth.velocity_m_per_s;
    let mut lever_axes = Matrix3::zeros();
    if let Some(turned) = &truth.turned {
        lever_axes = turned.orientation.to_rotation_matrix().into_inner();
        velocity += turned.rate_rad_per_s.cross(&(true_m - truth.position_m));
    } else if let Some(own) = fit.placed_orientation(pose) {
        lever_axes = -own.to_rotation_matrix().into_inner();
    }
    true_m += velocity * state.later_s;
    let turned_m = placed_m - fit.station1_from_estimate.translation_m;
    let scaled_m = fit.station1_from_estimate.rotate(&(fit.scale * pose.position_m));
    let mut design = [Vector3::zeros(); UNKNOWNS];
    for axis in 0..3 {
        let unit = Vector3::ith(axis, 1.0);
        design[axis] = -unit.cross(&turned_m);
        design[TRANSLATION + axis] = -unit;
        design[LEVER + axis] = lever_axes.column(axis).into_owned();
    }
    design[SCALE] = -scaled_m;
    design[CLOCK] = velocity;
    (true_m - placed_m, design)
}
