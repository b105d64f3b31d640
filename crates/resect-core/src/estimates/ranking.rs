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

use super::judged::Judged;
use super::metrics::{RELATIVE_M, RelativeError};
use crate::statistics::quantiles;

/// Number of blocks, shortest block (s), and smallest number of common blocks for a decision.
const BLOCKS: f64 = 24.0;
const SHORTEST_BLOCK_S: f64 = 5.0;
const FEWEST_BLOCKS: usize = 6;
const DRAWS: usize = 4000;
/// Smallest error in a draw, as a share of the larger of both.
const LEAST_SHARE: f64 = 1e-3;

/// A kind of error by which estimates are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ComparedError {
    /// Absolute error of positions (m).
    Position,
    /// Absolute error of orientations (rad).
    Rotation,
    /// Relative error of positions over a path of this length (m).
    PositionOverPath(f64),
    /// Relative error of orientations (rad) over a path of this length (m).
    RotationOverPath(f64),
}

impl ComparedError {
    /// Returns true if the errors are angles (rad); otherwise they are lengths (m).
    pub fn is_rotation(self) -> bool {
        matches!(self, Self::Rotation | Self::RotationOverPath(_))
    }
}

/// Comparison of two estimates by one kind of error over their common times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairComparison {
    pub kind: ComparedError,
    /// Indices of the estimates.
    pub better: usize,
    pub worse: usize,
    /// Root mean square errors over the common times, that of the better one first (m, rad).
    pub rmse: [f64; 2],
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
    /// Covariance of the ground truth, averaged over the epochs of both; zero if it states none.
    covariance: Matrix3<f64>,
}

/// An error at one time (s), and the covariance of the ground truth there.
struct TimedError {
    time_s: f64,
    error: Vector3<f64>,
    covariance: Option<Matrix3<f64>>,
}

/// Compares each pair of estimates by each kind of error that both have, pair by pair.
pub fn compare(all: &[Judged]) -> Vec<PairComparison> {
    let kinds: Vec<ComparedError> = [ComparedError::Position, ComparedError::Rotation]
        .into_iter()
        .chain(RELATIVE_M.into_iter().flat_map(|path_m| {
            [ComparedError::PositionOverPath(path_m), ComparedError::RotationOverPath(path_m)]
        }))
        .collect();
    let errors: Vec<Vec<Vec<TimedError>>> =
        all.iter().map(|one| kinds.iter().map(|kind| errors_of(one, *kind)).collect()).collect();
    let mut comparisons = Vec::new();
    for first in 0..all.len() {
        for second in first + 1..all.len() {
            for (index, kind) in kinds.iter().enumerate() {
                let both = [&errors[first][index][..], &errors[second][index]];
                comparisons.extend(compare_two(*kind, [first, second], both));
            }
        }
    }
    comparisons
}

/// Errors of one kind, in order of time. Inconclusive errors over paths are left out.
fn errors_of(judged: &Judged, kind: ComparedError) -> Vec<TimedError> {
    let epochs = judged.errors.iter();
    // The ground truth's own errors differ between the paths of two estimates, so chance contains them.
    let over_paths = |path_m: f64, of: &dyn Fn(&RelativeError) -> Option<Vector3<f64>>| {
        let relative = judged.relative.iter().find(|relative| relative.path_m == path_m);
        let relative = relative.filter(|relative| relative.are_conclusive());
        let paths = relative.map(|relative| &relative.paths[..]).unwrap_or_default();
        let timed = |path: &RelativeError| {
            Some(TimedError { time_s: path.time_s, error: of(path)?, covariance: None })
        };
        paths.iter().filter_map(timed).collect::<Vec<TimedError>>()
    };
    match kind {
        ComparedError::Position => epochs
            .map(|e| TimedError {
                time_s: e.time_s,
                error: e.position_m,
                covariance: e.covariance_m2,
            })
            .collect(),
        ComparedError::Rotation => epochs
            .filter_map(|e| {
                let error = e.rotation_rad?;
                Some(TimedError { time_s: e.time_s, error, covariance: e.covariance_rad2 })
            })
            .collect(),
        ComparedError::PositionOverPath(path_m) => {
            over_paths(path_m, &|path| Some(path.position_m))
        }
        ComparedError::RotationOverPath(path_m) => over_paths(path_m, &|path| path.rotation_rad),
    }
}

fn compare_two(
    kind: ComparedError,
    indices: [usize; 2],
    both: [&[TimedError]; 2],
) -> Option<PairComparison> {
    let blocks = blocks(both)?;
    let rmse = |k: usize| {
        let sum = |of: &dyn Fn(&BlockErrors) -> f64| blocks.iter().map(of).sum::<f64>();
        (sum(&|block| block.squares[k]) / sum(&|block| block.counts[k])).sqrt()
    };
    let both = [rmse(0), rmse(1)];
    let [better, worse] = if both[0] <= both[1] { [0, 1] } else { [1, 0] };
    let ratios = (blocks.len() >= FEWEST_BLOCKS).then(|| ratios(&blocks, better, worse, both));
    let count = DRAWS as f64;
    Some(PairComparison {
        kind,
        better: indices[better],
        worse: indices[worse],
        rmse: [both[better], both[worse]],
        ratio_95: ratios.as_ref().and_then(|all| quantiles(all.iter().copied(), [0.025, 0.975])),
        confidence: ratios
            .map(|all| all.iter().filter(|ratio| **ratio < 1.0).count() as f64 / count),
    })
}

fn blocks(both: [&[TimedError]; 2]) -> Option<Vec<BlockErrors>> {
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
            covariance: Matrix3::zeros(),
        })
        .collect();
    for (k, errors) in both.into_iter().enumerate() {
        for error in errors.iter().filter(|e| (from_s..=to_s).contains(&e.time_s)) {
            let block = &mut blocks[((error.time_s - from_s) / length_s) as usize];
            block.counts[k] += 1.0;
            block.squares[k] += error.error.norm_squared();
            block.sums[k] += error.error;
            block.covariance += error.covariance.unwrap_or_default();
        }
    }
    blocks.retain(|block| block.counts.iter().all(|count| *count > 0.0));
    for block in &mut blocks {
        block.covariance /= block.counts[0] + block.counts[1];
    }
    (!blocks.is_empty()).then_some(blocks)
}

/// Ratios of the better one's error to the worse one's, in draws of blocks.
fn ratios(blocks: &[BlockErrors], better: usize, worse: usize, rmse: [f64; 2]) -> Vec<f64> {
    let least = LEAST_SHARE * rmse[0].max(rmse[1]);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let roots: Vec<Option<Matrix3<f64>>> =
        blocks.iter().map(|block| block.covariance.cholesky().map(|root| root.l())).collect();
    (0..DRAWS)
        .map(|_| {
            let (mut squares, mut counts) = ([0.0_f64; 2], [0.0; 2]);
            for _ in 0..blocks.len() {
                let drawn = rng.random_range(0..blocks.len());
                let (block, root) = (&blocks[drawn], &roots[drawn]);
                let off = root.map_or(Vector3::zeros(), |root| {
                    root * Vector3::from_fn(|_, _| StandardNormal.sample(&mut rng))
                });
                for k in [0, 1] {
                    // |e − δ|² without |δ|², which is the same for both, summed over the block's epochs.
                    squares[k] += block.squares[k] - 2.0 * off.dot(&block.sums[k]);
                    counts[k] += block.counts[k];
                }
            }
            // A ground truth that is worse than both estimates may exceed their errors.
            let mean = |k: usize| (squares[k] / counts[k]).sqrt().max(least);
            mean(better) / mean(worse)
        })
        .collect()
}
