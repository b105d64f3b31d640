//! Significance of the difference between two estimates, given chance and the ground truth's own errors.
//!
//! Both estimates are compared at the same instants and over the same paths ([`common_errors`]). Errors drift, so epochs are not
//! independent samples: the squares of both are summed over the same blocks of time. Each block has a logarithm of the ratio of
//! errors, whose sign is a matter of chance if both are equally good, also where a vehicle stands or the errors of both are
//! large. σ of their mean is wider if neighbouring blocks are correlated, and if blocks are few (Student's t). The error of the
//! ground truth is the same for both estimates, so its common effect cancels.
//!
//! A difference counts from 3 σ on ([`SUPPORTED_SIGMAS`]). A pair is compared by up to ten kinds of error, so two equal
//! estimates have one significant difference in about 3 % of all comparisons; at 95 % it would be 40 %.

use nalgebra::{Matrix3, Vector3};

use super::common_errors::{self, CommonError};
use super::delta::RELATIVE_M;
use super::errors::EpochError;
use super::judged::Judged;
use resect_core::statistics::estimate::{Estimate, SUPPORTED_SIGMAS};
use resect_core::statistics::median;
use resect_core::statistics::tables::{NORMAL_95, normal_probability, student_sigmas};

/// Numbers of blocks, shortest block (s), and smallest number of blocks for a decision. Absolute errors are correlated over as
/// long as a drift takes to change, which no single length of block fits: the least significant of several counts. Relative
/// errors of consecutive paths share no drift.
const BLOCKS_OF_INSTANTS: &[f64] = &[24.0, 12.0, 6.0];
const BLOCKS_OF_PATHS: &[f64] = &[24.0];
const SHORTEST_BLOCK_S: f64 = 5.0;
const FEWEST_BLOCKS: f64 = 6.0;
/// Smallest number of paths for a decision, and the largest ratio of their length to the nominal one.
const FEWEST_PATHS: usize = 10;
const LONGER: f64 = 1.5;
/// Smallest error, as a share of the larger of both.
const LEAST_SHARE: f64 = 1e-3;
/// Errors whose logarithms differ less are equal for all purposes.
const ALIKE: f64 = 1e-3;
/// Errors below this size (m, rad) are those of numbers that are rounded in files.
const ROUNDED: f64 = 1e-6;

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
    /// Returns all kinds: absolute errors first, then relative ones by length.
    pub fn all() -> Vec<Self> {
        let relative = RELATIVE_M
            .into_iter()
            .flat_map(|path_m| [Self::PositionOverPath(path_m), Self::RotationOverPath(path_m)]);
        [Self::Position, Self::Rotation].into_iter().chain(relative).collect()
    }

    /// Returns true if the errors are angles (rad); otherwise they are lengths (m).
    pub fn is_rotation(self) -> bool {
        matches!(self, Self::Rotation | Self::RotationOverPath(_))
    }
}

/// Comparison of two estimates by one kind of error, at common instants or over common paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairComparison {
    pub kind: ComparedError,
    /// Indices of the estimates.
    pub better: usize,
    pub worse: usize,
    /// Root mean square errors, that of the better one first (m, rad).
    pub rmse: [f64; 2],
    /// Number of common instants or paths.
    pub count: usize,
    /// True if the errors over paths are those of distances, because an estimate has no orientations.
    pub is_of_distances: bool,
    /// Logarithm of the typical ratio of the worse one's errors to the better one's. Its 3 σ have the probability of a normal
    /// distribution. `None` if the verdict has no statistics.
    pub ln_factor: Option<Estimate>,
    pub verdict: PairVerdict,
}

/// Conclusion of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PairVerdict {
    /// The better one is significantly better.
    Better,
    /// The difference is below 3 σ.
    NotSignificant,
    /// The errors are equal.
    Alike,
    /// Too few common paths of this length.
    FewPaths,
    /// The poses are further apart than the length of the paths.
    SparsePoses,
    /// Too few blocks of time.
    FewBlocks,
}

impl PairComparison {
    /// Returns true if the difference is significant.
    pub fn is_significant(&self) -> bool {
        self.verdict == PairVerdict::Better
    }

    /// Typical factor by which the worse one's error is larger, and its σ: the geometric mean over blocks of time.
    pub fn factor(&self) -> Option<Estimate> {
        let Estimate { value, sigma } = self.ln_factor?;
        Some(Estimate { value: value.exp(), sigma: value.exp() * sigma })
    }

    /// Difference in σ; negative if the worse one by root mean square is typically better.
    pub fn sigmas(&self) -> Option<f64> {
        self.ln_factor.filter(|one| one.sigma > 0.0).map(|one| one.value / one.sigma)
    }

    /// 95 % interval of the better one's error over the worse one's.
    pub fn ratio_95(&self) -> Option<[f64; 2]> {
        let Estimate { value, sigma } = self.ln_factor?;
        Some([-NORMAL_95, NORMAL_95].map(|by| (by * sigma - value).exp()))
    }

    /// Probability that the better one is better.
    pub fn confidence(&self) -> Option<f64> {
        self.sigmas().map(normal_probability)
    }
}

/// Sums of both estimates' errors over one block of time.
#[derive(Clone, Default)]
struct BlockErrors {
    count: f64,
    squares: [f64; 2],
    sums: [Vector3<f64>; 2],
    /// Covariance of the ground truth, averaged over the block.
    covariance: Matrix3<f64>,
}

/// Compares each pair of estimates by each kind of error that both have, pair by pair.
pub fn compare(all: &[Judged]) -> Vec<PairComparison> {
    let mut comparisons = Vec::new();
    for first in 0..all.len() {
        for second in first + 1..all.len() {
            let both = [first, second].map(|index| &all[index].errors[..]);
            comparisons.extend(compare_pair([first, second], both));
        }
    }
    comparisons
}

/// Compares two estimates by all kinds of errors; the indices name them.
pub fn compare_pair(indices: [usize; 2], both: [&[EpochError]; 2]) -> Vec<PairComparison> {
    let pairs = common_errors::common_instants(both[0], both[1]);
    let mut comparisons = Vec::new();
    let mut add = |kind, errors: &[CommonError], is_of_distances| {
        let comparison = compare_errors(kind, indices, errors);
        comparisons.extend(comparison.map(|one| PairComparison { is_of_distances, ..one }));
    };
    add(ComparedError::Position, &common_errors::positions(&pairs), false);
    add(ComparedError::Rotation, &common_errors::rotations(&pairs), false);
    for path_m in RELATIVE_M {
        let paths = common_errors::over_paths(&pairs, path_m);
        let positions: Vec<CommonError> = paths.iter().map(|path| path.position).collect();
        let rotations: Vec<CommonError> = paths.iter().filter_map(|path| path.rotation).collect();
        add(ComparedError::PositionOverPath(path_m), &positions, rotations.is_empty());
        add(ComparedError::RotationOverPath(path_m), &rotations, false);
    }
    comparisons
}

fn compare_errors(
    kind: ComparedError,
    indices: [usize; 2],
    errors: &[CommonError],
) -> Option<PairComparison> {
    let count = errors.len();
    let rmse = [0, 1].map(|k| {
        let squares: f64 = errors.iter().map(|one| one.errors[k].norm_squared()).sum();
        (squares / count as f64).sqrt()
    });
    let [better, worse] = if rmse[0] <= rmse[1] { [0, 1] } else { [1, 0] };
    let comparison = PairComparison {
        kind,
        better: indices[better],
        worse: indices[worse],
        rmse: [rmse[better], rmse[worse]],
        count,
        is_of_distances: false,
        ln_factor: None,
        verdict: PairVerdict::FewBlocks,
    };
    let unfit = match kind {
        ComparedError::PositionOverPath(path_m) | ComparedError::RotationOverPath(path_m) => {
            let length_m = median(errors.iter().map(|one| one.length_m)).unwrap_or_default();
            let is_sparse = length_m >= LONGER * path_m;
            let is_short = count < FEWEST_PATHS;
            is_sparse
                .then_some(PairVerdict::SparsePoses)
                .or(is_short.then_some(PairVerdict::FewPaths))
        }
        ComparedError::Position | ComparedError::Rotation => None,
    };
    if count == 0 {
        return None;
    }
    if let Some(verdict) = unfit {
        return Some(PairComparison { verdict, ..comparison });
    }
    let counts = match kind {
        ComparedError::Position | ComparedError::Rotation => BLOCKS_OF_INSTANTS,
        ComparedError::PositionOverPath(_) | ComparedError::RotationOverPath(_) => BLOCKS_OF_PATHS,
    };
    let each = counts.iter().filter_map(|count| ln_factor(&blocks(errors, *count)));
    let sigmas = |one: &Estimate| one.value.abs() / one.sigma.max(f64::MIN_POSITIVE);
    let ln_factor = each.min_by(|a, b| sigmas(a).total_cmp(&sigmas(b))).map(|one| {
        let sign = if better == 0 { 1.0 } else { -1.0 };
        Estimate { value: sign * one.value, ..one }
    });
    let comparison = PairComparison { ln_factor, ..comparison };
    let [_, larger] = comparison.rmse;
    let is_alike = larger - comparison.rmse[0] <= ALIKE * larger || larger < ROUNDED;
    let verdict = match comparison.sigmas() {
        _ if is_alike => PairVerdict::Alike,
        Some(sigmas) if sigmas >= SUPPORTED_SIGMAS => PairVerdict::Better,
        Some(_) => PairVerdict::NotSignificant,
        None => PairVerdict::FewBlocks,
    };
    Some(PairComparison { verdict, ..comparison })
}

/// Sums errors over at most a number of blocks of time; empty blocks are left out.
fn blocks(errors: &[CommonError], most: f64) -> Vec<BlockErrors> {
    let [Some(first), Some(last)] = [errors.first(), errors.last()] else { return Vec::new() };
    let span_s = last.time_s - first.time_s;
    let length_s = (span_s / most).max(SHORTEST_BLOCK_S);
    let count = (span_s / length_s).ceil().max(1.0) as usize;
    let mut blocks = vec![BlockErrors::default(); count];
    for error in errors {
        let index = ((error.time_s - first.time_s) / length_s).max(0.0) as usize;
        let block = &mut blocks[index.min(count - 1)];
        block.count += 1.0;
        block.covariance += error.covariance;
        for (k, own) in error.errors.iter().enumerate() {
            block.squares[k] += own.norm_squared();
            block.sums[k] += own;
        }
    }
    blocks.retain(|block| block.count > 0.0);
    blocks.iter_mut().for_each(|block| block.covariance /= block.count);
    blocks
}

/// Logarithm of the second one's errors over the first one's, averaged over blocks, with its σ; `None` with too few blocks.
fn ln_factor(blocks: &[BlockErrors]) -> Option<Estimate> {
    let count = blocks.len() as f64;
    if count < FEWEST_BLOCKS {
        return None;
    }
    let (mut ln_factors, mut of_truth) = (Vec::new(), 0.0);
    for block in blocks {
        let least = LEAST_SHARE.powi(2) * block.squares[0].max(block.squares[1]);
        let squares = block.squares.map(|square| square.max(least).max(f64::MIN_POSITIVE));
        ln_factors.push(0.5 * (squares[1] / squares[0]).ln());
        // |e − δ|² without |δ|², which is the same for both: an error δ of the ground truth changes the sums by −2 δ · Σe.
        let by_truth = block.sums[1] / squares[1] - block.sums[0] / squares[0];
        of_truth += by_truth.dot(&(block.covariance * by_truth)) / count.powi(2);
    }
    let mean = ln_factors.iter().sum::<f64>() / count;
    let off: Vec<f64> = ln_factors.iter().map(|ln_factor| ln_factor - mean).collect();
    let square: f64 = off.iter().map(|off| off * off).sum();
    let product: f64 = off.windows(2).map(|two| two[0] * two[1]).sum();
    // The estimate of a correlation from few values is too small by about 1/n.
    let correlation = if square > 0.0 { product / square + 1.0 / count } else { 0.0 };
    let correlation = correlation.clamp(0.0, 1.0 - 1e-9);
    let repeats = (1.0 + correlation) / (1.0 - correlation);
    let of_blocks = square / (count - 1.0) / count * repeats;
    let widened = student_sigmas(SUPPORTED_SIGMAS, count / repeats - 1.0) / SUPPORTED_SIGMAS;
    Some(Estimate { value: mean, sigma: widened * (of_blocks + of_truth).sqrt() })
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// Errors that drift as a random walk, aligned by their mean, during a drive of 420 s at 5 Hz that stops for 20 s each minute.
    fn drifting(seed: u64, drift_m: f64) -> Vec<EpochError> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut step = || Vector3::from_fn(|_, _| StandardNormal.sample(&mut rng));
        let mut walks = [Vector3::zeros(); 2];
        let mut along_m = 0.0;
        let mut epochs: Vec<EpochError> = (0..2100)
            .map(|index| {
                walks[0] += drift_m * step();
                walks[1] += 0.05 * drift_m * step();
                along_m += if index % 300 < 200 { 0.16 } else { 0.0 };
                EpochError {
                    time_s: f64::from(index) * 0.2,
                    true_position_m: Vector3::new(along_m, 0.0, 0.0),
                    position_m: walks[0],
                    rotation_rad: Some(walks[1]),
                    covariance_m2: None,
                    covariance_rad2: None,
                    contradiction_m: None,
                }
            })
            .collect();
        let count = epochs.len() as f64;
        let mean_m = epochs.iter().map(|epoch| epoch.position_m).sum::<Vector3<f64>>() / count;
        let mean_rad = epochs.iter().filter_map(|epoch| epoch.rotation_rad).sum::<Vector3<f64>>();
        for epoch in &mut epochs {
            epoch.position_m -= mean_m;
            epoch.rotation_rad = epoch.rotation_rad.map(|turn| turn - mean_rad / count);
        }
        epochs
    }

    /// Errors of a nanometre are those of rounding, and say nothing about two estimates.
    #[test]
    fn errors_of_rounding_are_alike() {
        let [a, b] = [(1, 1e-9), (2, 1e-8)].map(|(seed, drift_m)| drifting(seed, drift_m));
        let comparisons = compare_pair([0, 1], [&a, &b]);
        assert!(comparisons.iter().any(|two| two.verdict == PairVerdict::Alike));
        assert!(comparisons.iter().all(|two| !two.is_significant()), "{comparisons:?}");
    }

    /// Each kind of error is inconclusive for 200 pairs with equal drift: relative errors for at least 98 %, absolute ones for 95 %.
    #[test]
    fn equal_drift_is_inconclusive_and_twice_the_drift_is_found() {
        const PAIRS: u64 = 200;
        let all: Vec<[Vec<PairComparison>; 2]> = (0..PAIRS)
            .map(|seed| {
                let [a, b, twice] = [(0, 0.005), (1, 0.005), (2, 0.01)]
                    .map(|(of, drift_m)| drifting(3 * seed + of, drift_m));
                [compare_pair([0, 1], [&a, &b]), compare_pair([0, 1], [&a, &twice])]
            })
            .collect();
        for kind in ComparedError::all() {
            let of = |pair: usize| {
                all.iter().flat_map(move |both| &both[pair]).filter(move |two| two.kind == kind)
            };
            let alarms = of(0).filter(|two| two.is_significant()).count();
            let found = of(1).filter(|two| two.is_significant() && two.better == 0).count();
            let paths = of(0).map(|two| two.count).min().unwrap_or_default();
            let is_over_paths = !matches!(kind, ComparedError::Position | ComparedError::Rotation);
            assert!(alarms <= if is_over_paths { 4 } else { 10 }, "{kind:?}: {alarms} alarms");
            assert!(!is_over_paths || paths < 100 || found >= 180, "{kind:?}: {found} found");
            let are_few = of(0).all(|two| two.verdict == PairVerdict::FewPaths);
            assert_eq!(are_few, is_over_paths && paths < 10, "{kind:?}");
        }
    }
}
