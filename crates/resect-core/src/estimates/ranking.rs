//! Significance of the difference between two estimates, given chance and the ground truth's own errors.
//!
//! Errors of estimates drift, so epochs are not independent samples. The errors of both are summed over the same blocks of
//! time, and the blocks are drawn with replacement (Künsch 1989, "The jackknife and the bootstrap for general stationary
//! observations"). In each draw the ground truth of a block has a common error, drawn from its covariance there. The error is
//! the same for both estimates, so what they have in common cancels.

use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::errors::EpochError;
use crate::statistics::quantiles;

/// Number of blocks, shortest block (s), and smallest number of common blocks for a decision.
const BLOCKS: f64 = 24.0;
const SHORTEST_BLOCK_S: f64 = 5.0;
const FEWEST_BLOCKS: usize = 6;
const DRAWS: usize = 4000;

/// Comparison of two estimates over their common times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairComparison {
    /// Indices of the estimates.
    pub better: usize,
    pub worse: usize,
    /// Root mean square position errors over the common times, that of the better one first (m).
    pub rmse_m: [f64; 2],
    /// 95 % interval of the better one's error over the worse one's; `None` if the drive is too short.
    pub ratio_95: Option<[f64; 2]>,
    /// Share of the draws in which the better one is better.
    pub confidence: Option<f64>,
}

impl PairComparison {
    /// Returns true if the difference is significant: chance would cause it less than once in forty.
    pub fn is_significant(&self) -> bool {
        self.confidence.is_some_and(|confidence| confidence > 0.975)
    }
}

/// Sums of both estimates' errors over one block of time.
struct BlockErrors {
    counts: [f64; 2],
    squares: [f64; 2],
    sums: [Vector3<f64>; 2],
    /// Covariance of the ground truth, averaged over the epochs of both.
    covariance_m2: Matrix3<f64>,
}

/// Compares each pair of estimates.
pub fn compare(all: &[&[EpochError]]) -> Vec<PairComparison> {
    let mut found = Vec::new();
    for first in 0..all.len() {
        for second in first + 1..all.len() {
            found.extend(compare_two([first, second], [all[first], all[second]]));
        }
    }
    found
}

fn compare_two(indices: [usize; 2], both: [&[EpochError]; 2]) -> Option<PairComparison> {
    let blocks = blocks(both)?;
    let rmse = |k: usize| {
        let sum = |of: &dyn Fn(&BlockErrors) -> f64| blocks.iter().map(of).sum::<f64>();
        (sum(&|block| block.squares[k]) / sum(&|block| block.counts[k])).sqrt()
    };
    let rmse_m = [rmse(0), rmse(1)];
    let [better, worse] = if rmse_m[0] <= rmse_m[1] { [0, 1] } else { [1, 0] };
    let ratios = (blocks.len() >= FEWEST_BLOCKS).then(|| ratios(&blocks, better, worse));
    let count = DRAWS as f64;
    Some(PairComparison {
        better: indices[better],
        worse: indices[worse],
        rmse_m: [rmse_m[better], rmse_m[worse]],
        ratio_95: ratios.as_ref().and_then(|all| quantiles(all.iter().copied(), [0.025, 0.975])),
        confidence: ratios
            .map(|all| all.iter().filter(|ratio| **ratio < 1.0).count() as f64 / count),
    })
}

fn blocks(both: [&[EpochError]; 2]) -> Option<Vec<BlockErrors>> {
    let (a, b) = (both[0], both[1]);
    let from_s = a.first()?.time_s.max(b.first()?.time_s);
    let to_s = a.last()?.time_s.min(b.last()?.time_s);
    if to_s <= from_s {
        return None;
    }
    let length_s = ((to_s - from_s) / BLOCKS).max(SHORTEST_BLOCK_S);
    let count = ((to_s - from_s) / length_s) as usize + 1;
    let mut blocks: Vec<BlockErrors> = (0..count)
        .map(|_| BlockErrors {
            counts: [0.0; 2],
            squares: [0.0; 2],
            sums: [Vector3::zeros(); 2],
            covariance_m2: Matrix3::zeros(),
        })
        .collect();
    for (k, errors) in both.into_iter().enumerate() {
        for error in errors.iter().filter(|e| (from_s..=to_s).contains(&e.time_s)) {
            let block = &mut blocks[((error.time_s - from_s) / length_s) as usize];
            block.counts[k] += 1.0;
            block.squares[k] += error.position_m.norm_squared();
            block.sums[k] += error.position_m;
            block.covariance_m2 += error.covariance_m2;
        }
    }
    blocks.retain(|block| block.counts.iter().all(|count| *count > 0.0));
    for block in &mut blocks {
        block.covariance_m2 /= block.counts[0] + block.counts[1];
    }
    (!blocks.is_empty()).then_some(blocks)
}

/// Ratios of the better one's error to the worse one's, in draws of blocks.
fn ratios(blocks: &[BlockErrors], better: usize, worse: usize) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let roots: Vec<Matrix3<f64>> = blocks
        .iter()
        .map(|block| block.covariance_m2.cholesky().map_or(Matrix3::zeros(), |root| root.l()))
        .collect();
    (0..DRAWS)
        .map(|_| {
            let (mut squares, mut counts) = ([0.0_f64; 2], [0.0; 2]);
            for _ in 0..blocks.len() {
                let drawn = rng.random_range(0..blocks.len());
                let (block, root) = (&blocks[drawn], &roots[drawn]);
                let off = root * Vector3::from_fn(|_, _| StandardNormal.sample(&mut rng));
                for k in [0, 1] {
                    // |e − δ|² without |δ|², which is the same for both, summed over the block's epochs.
                    squares[k] += block.squares[k] - 2.0 * off.dot(&block.sums[k]);
                    counts[k] += block.counts[k];
                }
            }
            let mean = |k: usize| (squares[k] / counts[k]).max(0.0).sqrt();
            mean(better) / mean(worse)
        })
        .collect()
}
