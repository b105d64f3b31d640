//! Significance of the difference between two estimates, given chance and the ground truth's own errors.
//!
//! Both estimates are compared at the same instants and over the same paths ([`common_errors`]). Errors drift, so epochs are not
//! independent samples: the squares of both are summed over the same blocks of time. Each block has a logarithm of the ratio of
//! errors, whose sign is a matter of chance if both are equally good, also where a vehicle stands or the errors of both are
//! large. σ of their mean is wider if neighbouring blocks are correlated, and if blocks are few (Student's t). The error of the
//! ground truth is the same for both estimates, so its common effect cancels.
//!
//! A difference counts from 3 σ on ([`SUPPORTED_SIGMAS`]). A pair is compared by up to ten kinds of error, so two equal
//! estimates have one significant difference in 4 to 5 % of all comparisons; at 95 % it would be 40 %.

use nalgebra::{Matrix3, Vector3};

use super::common_errors::{self, CommonError};
use super::delta::{Delta, RelativeOptions};
use super::errors::EpochError;
use super::judged::Judged;
use super::varied_errors;
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
    /// Relative error of positions (m) over motions of this size.
    PositionOver(Delta),
    /// Relative error of orientations (rad) over motions of this size.
    RotationOver(Delta),
}

impl ComparedError {
    /// Returns all kinds: absolute errors first, then relative ones by the size of motions.
    pub fn all(motions: &RelativeOptions) -> Vec<Self> {
        let relative = motions
            .deltas
            .iter()
            .flat_map(|delta| [Self::PositionOver(*delta), Self::RotationOver(*delta)]);
        [Self::Position, Self::Rotation].into_iter().chain(relative).collect()
    }

    /// Returns true if the errors are angles (rad); otherwise they are lengths (m).
    pub fn is_rotation(self) -> bool {
        matches!(self, Self::Rotation | Self::RotationOver(_))
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
    /// Too few common motions of this size.
    FewPaths,
    /// The poses are further apart than the size of the motions.
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

    /// 95 % interval of the factor.
    pub fn factor_95(&self) -> Option<[f64; 2]> {
        let Estimate { value, sigma } = self.ln_factor?;
        Some([-NORMAL_95, NORMAL_95].map(|by| (value + by * sigma).exp()))
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
pub fn compare(all: &[Judged], motions: &RelativeOptions) -> Vec<PairComparison> {
    let mut comparisons = Vec::new();
    for first in 0..all.len() {
        for second in first + 1..all.len() {
            comparisons.extend(compare_pair([first, second], [&all[first], &all[second]], motions));
        }
    }
    comparisons
}

/// Compares two estimates by all kinds of errors; the indices name them.
fn compare_pair(
    indices: [usize; 2],
    [first, second]: [&Judged; 2],
    motions: &RelativeOptions,
) -> Vec<PairComparison> {
    let mut kinds = errors_by_kind([&first.errors, &second.errors], motions);
    // Clock, lever arm and body are known only within their σ.
    for changes in &first.changes {
        let changed = varied_errors::changed(&first.errors, changes);
        add_changed(&mut kinds, [&changed, &second.errors], motions);
    }
    for changes in &second.changes {
        let changed = varied_errors::changed(&second.errors, changes);
        add_changed(&mut kinds, [&first.errors, &changed], motions);
    }
    kinds.iter().filter_map(|kind| compare_errors(kind, indices)).collect()
}

/// Errors of one kind of two estimates.
struct ErrorsOfKind {
    kind: ComparedError,
    errors: Vec<CommonError>,
    is_of_distances: bool,
    /// The same errors with independent changes of clock, lever arm and body by one σ.
    changed: Vec<Vec<CommonError>>,
}

fn errors_by_kind(both: [&[EpochError]; 2], motions: &RelativeOptions) -> Vec<ErrorsOfKind> {
    let pairs = common_errors::common_instants(both[0], both[1]);
    let mut kinds = Vec::new();
    let mut add = |kind, errors, is_of_distances| {
        kinds.push(ErrorsOfKind { kind, errors, is_of_distances, changed: Vec::new() });
    };
    add(ComparedError::Position, common_errors::positions(&pairs), false);
    add(ComparedError::Rotation, common_errors::rotations(&pairs), false);
    for &delta in &motions.deltas {
        let Some(each) = common_errors::over_motions(&pairs, delta) else { continue };
        let positions: Vec<CommonError> = each.iter().map(|motion| motion.position).collect();
        let rotations: Vec<CommonError> =
            each.iter().filter_map(|motion| motion.rotation).collect();
        add(ComparedError::PositionOver(delta), positions, rotations.is_empty());
        add(ComparedError::RotationOver(delta), rotations, false);
    }
    kinds
}

fn add_changed(kinds: &mut [ErrorsOfKind], both: [&[EpochError]; 2], motions: &RelativeOptions) {
    for (kind, changed) in kinds.iter_mut().zip(errors_by_kind(both, motions)) {
        kind.changed.push(changed.errors);
    }
}

fn compare_errors(of_kind: &ErrorsOfKind, indices: [usize; 2]) -> Option<PairComparison> {
    let &ErrorsOfKind { kind, ref errors, is_of_distances, ref changed } = of_kind;
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
        is_of_distances,
        ln_factor: None,
        verdict: PairVerdict::FewBlocks,
    };
    let unfit = match kind {
        ComparedError::PositionOver(delta) | ComparedError::RotationOver(delta) => {
            let size = median(errors.iter().map(|error| error.size)).unwrap_or_default();
            let is_sparse = size >= LONGER * delta.value();
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
        ComparedError::PositionOver(_) | ComparedError::RotationOver(_) => BLOCKS_OF_PATHS,
    };
    let each = counts.iter().filter_map(|count| {
        let Estimate { value, sigma } = ln_factor(&blocks(errors, *count))?;
        let by_changes =
            changed.iter().filter_map(|errors| Some(ln_factor(&blocks(errors, *count))?.value));
        let variance: f64 = by_changes.map(|changed| (changed - value).powi(2)).sum();
        Some(Estimate { value, sigma: sigma.hypot(variance.sqrt()) })
    });
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
    // A correlation ρ from n values is too small by (1 + 4ρ)/n on average (Marriott and Pope 1954).
    // Simulated: of 2000 pairs with equal drift, 5.4 % had a significant difference with 1/n, and 4.6 % have one.
    let correlation = if square > 0.0 { product / square } else { 0.0 };
    let correlation = correlation + (1.0 + 4.0 * correlation.max(0.0)) / count;
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

    fn compared(both: [&Vec<EpochError>; 2]) -> Vec<PairComparison> {
        let kinds = errors_by_kind(both.map(|errors| &errors[..]), &RelativeOptions::default());
        kinds.iter().filter_map(|kind| compare_errors(kind, [0, 1])).collect()
    }

    /// A lever arm that is uncertain by as much as the errors differ decides nothing.
    #[test]
    fn changes_by_clock_and_lever_arm_widen_sigma() {
        let [a, twice] = [(1, 0.005), (2, 0.01)].map(|(seed, drift_m)| drifting(seed, drift_m));
        let motions = RelativeOptions::default();
        let sure = compared([&a, &twice]);
        let mut kinds = errors_by_kind([&a, &twice], &motions);
        let changed: Vec<EpochError> = a
            .iter()
            .map(|error| EpochError { position_m: 2.0 * error.position_m, ..error.clone() })
            .collect();
        add_changed(&mut kinds, [&changed, &twice], &motions);
        for (kind, sure) in kinds.iter().zip(&sure) {
            let wide = compare_errors(kind, [0, 1]).expect("errors");
            let [before, now] = [sure, &wide].map(|it| it.ln_factor.map(|factor| factor.sigma));
            if kind.kind.is_rotation() {
                assert_eq!(now, before, "{:?}", kind.kind);
            }
            if kind.kind == ComparedError::Position {
                // All errors of one estimate are doubled.
                let [before, now] = [before, now].map(|sigma| sigma.expect("long drive"));
                assert!((now.powi(2) - before.powi(2) - 2.0_f64.ln().powi(2)).abs() < 1e-9);
            }
        }
    }

    /// Errors of a nanometre are those of rounding, and say nothing about two estimates.
    #[test]
    fn errors_of_rounding_are_alike() {
        let [a, b] = [(1, 1e-9), (2, 1e-8)].map(|(seed, drift_m)| drifting(seed, drift_m));
        let comparisons = compared([&a, &b]);
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
                [compared([&a, &b]), compared([&a, &twice])]
            })
            .collect();
        for kind in ComparedError::all(&RelativeOptions::default()) {
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
