//! Priors of the slow states: poses and clocks of stations are random walks from block to block, and range errors are
//! Ornstein–Uhlenbeck processes.

use nalgebra::SMatrix;

use super::state_vector::{SLOW, SLOW_CLOCKS, SLOW_RANGES};

pub type SlowMatrix = SMatrix<f64, SLOW, SLOW>;
/// A matrix of the states that are random walks: poses of stations 2 and 3, and their clocks.
pub type WalkMatrix = SMatrix<f64, SLOW_RANGES, SLOW_RANGES>;

/// Variance of a detected step, as a multiple of that of a whole drive.
const STEP_MULTIPLE: f64 = 1e4;

/// The Ornstein–Uhlenbeck process of a station's range errors: standard deviation (m) and correlation time (s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeWander {
    pub sigma_m: f64,
    pub correlation_s: f64,
}

impl RangeWander {
    /// The smallest process that is tried, with which the estimate starts.
    pub const SMALLEST: Self =
        Self { sigma_m: WANDER_SIGMAS_M[0], correlation_s: WANDER_TIMES_S[1] };
}

/// Standard deviations (m) and correlation times (s) of range errors that are tried.
pub const WANDER_SIGMAS_M: [f64; 7] = [1e-4, 4e-4, 8e-4, 0.0014, 0.0025, 0.0045, 0.008];
pub const WANDER_TIMES_S: [f64; 3] = [3.0, 12.0, 50.0];

/// Priors of the slow states.
#[derive(Clone, Debug)]
pub struct SlowPriors {
    /// Variance of the random walks of (x, y, z, yaw) of stations 2 and 3 over a whole drive (m², rad²).
    pub settling: SMatrix<f64, 8, 8>,
    /// Variance of the random walks of the clocks of stations 2 and 3 over a whole drive (s²).
    pub clocks_s2: f64,
    pub wander: RangeWander,
    /// Starts of further drives (s). Stations may have settled since then as much as during a drive; clocks start anew with this
    /// variance (s²).
    pub restarts_s: Vec<f64>,
    pub restarted_s2: f64,
    /// Blocks before which a station, or a clock, has a detected step.
    pub station_steps: Vec<usize>,
    pub clock_steps: Vec<usize>,
}

/// Block tridiagonal precision matrix of the slow states. Its blocks are computed when they are needed: stored, those of a long drive
/// would need more memory than its readings.
#[derive(Clone)]
pub struct SlowPrecisions {
    /// Precision of the random walk of the poses over a whole drive.
    settling: SMatrix<f64, 8, 8>,
    transitions: Vec<Transition>,
    pub ln_determinant: f64,
}

/// Transition to a block from the block before it, or to the first block from the set-up.
#[derive(Clone, Copy)]
struct Transition {
    /// Variance of the poses' increment as a share of that of a whole drive, and the same without a detected step.
    pose_share: f64,
    share_without_step: f64,
    /// Precision of each clock's increment (1/s²).
    clock_precision: f64,
    /// Correlation of the range errors with those of the block before, and precision of the innovation (1/m²).
    correlation: f64,
    innovation_precision: f64,
}

impl SlowPrecisions {
    /// The precision for blocks at these times (s); `None` if a variance is not positive.
    pub fn new(priors: &SlowPriors, time_s: &[f64]) -> Option<Self> {
        let restarts = |block: usize| {
            block > 0
                && priors
                    .restarts_s
                    .iter()
                    .any(|at| (time_s[block - 1]..time_s[block]).contains(at))
        };
        let paused_s: f64 = (0..time_s.len())
            .filter(|block| restarts(*block))
            .map(|block| time_s[block] - time_s[block - 1])
            .sum();
        let drives = (priors.restarts_s.len() + 1) as f64;
        // A whole drive.
        let whole_s = ((time_s.last()? - time_s.first()? - paused_s) / drives).max(1.0);
        let factor = priors.settling.cholesky()?;
        let (settling, ln_settling) = (factor.inverse(), factor.ln_determinant());
        let mut ln_determinant = 0.0;
        let variance_m2 = priors.wander.sigma_m.powi(2);
        let transition = |block: usize| {
            let since_s = match block {
                // From the set-up to the first block.
                0 => 0.5 * whole_s * drives / time_s.len() as f64,
                _ => time_s[block] - time_s[block - 1],
            };
            let share_without_step =
                if restarts(block) { 1.0 } else { (since_s / whole_s).max(1e-4) };
            let share = |steps: &[usize]| {
                if steps.contains(&block) { STEP_MULTIPLE } else { share_without_step }
            };
            let (pose_share, clock_share) =
                (share(&priors.station_steps), share(&priors.clock_steps));
            let clocks_s2 =
                if restarts(block) { priors.restarted_s2 } else { clock_share * priors.clocks_s2 };
            ln_determinant -= ln_settling + 8.0 * pose_share.ln() + 2.0 * clocks_s2.ln();
            let correlation =
                if block == 0 { 0.0 } else { (-since_s / priors.wander.correlation_s).exp() };
            let innovation_precision =
                1.0 / (variance_m2 * (1.0 - correlation * correlation).max(1e-6));
            for _ in SLOW_RANGES..SLOW {
                ln_determinant += innovation_precision.ln();
            }
            Transition {
                pose_share,
                share_without_step,
                clock_precision: clocks_s2.recip(),
                correlation,
                innovation_precision,
            }
        };
        let transitions = (0..time_s.len()).map(transition).collect();
        Some(Self { settling, transitions, ln_determinant })
    }

    /// The precision for standard deviations a thousand times smaller.
    pub fn stiffer(&self) -> Self {
        const MORE: f64 = 1e6;
        let stiffer = |transition: &Transition| Transition {
            clock_precision: transition.clock_precision * MORE,
            innovation_precision: transition.innovation_precision * MORE,
            ..*transition
        };
        let transitions = self.transitions.iter().map(stiffer).collect();
        Self { settling: self.settling * MORE, transitions, ln_determinant: self.ln_determinant }
    }

    /// Diagonal block of the precision matrix.
    pub fn diagonal(&self, block: usize) -> SlowMatrix {
        let (transition, next) = (self.transitions[block], self.transitions.get(block + 1));
        let mut own = SlowMatrix::zeros();
        let mut walk = self.increment_precision(block);
        let mut range_precision = transition.innovation_precision;
        if let Some(next) = next {
            walk += self.increment_precision(block + 1);
            range_precision += next.correlation * next.correlation * next.innovation_precision;
        }
        own.fixed_view_mut::<SLOW_RANGES, SLOW_RANGES>(0, 0).copy_from(&walk);
        (SLOW_RANGES..SLOW).for_each(|range| own[(range, range)] = range_precision);
        own
    }

    /// Block of the precision matrix right of the diagonal.
    pub fn upper(&self, block: usize) -> SlowMatrix {
        let mut both = SlowMatrix::zeros();
        let Some(next) = self.transitions.get(block + 1) else { return both };
        let walk = -self.increment_precision(block + 1);
        both.fixed_view_mut::<SLOW_RANGES, SLOW_RANGES>(0, 0).copy_from(&walk);
        (SLOW_RANGES..SLOW)
            .for_each(|range| both[(range, range)] = -next.correlation * next.innovation_precision);
        both
    }

    /// Precision of the random walks' increment to a block from the one before it.
    pub fn increment_precision(&self, block: usize) -> WalkMatrix {
        let transition = self.transitions[block];
        let mut walk = WalkMatrix::zeros();
        walk.fixed_view_mut::<8, 8>(0, 0).copy_from(&(self.settling / transition.pose_share));
        (SLOW_CLOCKS..SLOW_RANGES)
            .for_each(|clock| walk[(clock, clock)] = transition.clock_precision);
        walk
    }

    /// Precision of the random walks' increment from the first block to the last; `None` if it is singular.
    pub fn whole_drive_precision(&self) -> Option<WalkMatrix> {
        let mut covariance = WalkMatrix::zeros();
        for block in 1..self.transitions.len() {
            covariance += self.increment_precision(block).cholesky()?.inverse();
        }
        Some(covariance.cholesky()?.inverse())
    }

    /// Variance of the poses at each block without steps, as a share of that of a whole drive.
    pub fn variance_shares(&self) -> Vec<f64> {
        let mut share = 0.0;
        let until = |transition: &Transition| {
            share += transition.share_without_step;
            share
        };
        self.transitions.iter().map(until).collect()
    }

    /// Block row of the product of the precision matrix with slow states.
    pub fn multiply<const K: usize>(
        &self,
        slow: &[SMatrix<f64, SLOW, K>],
        block: usize,
    ) -> SMatrix<f64, SLOW, K> {
        let mut product = self.diagonal(block) * slow[block];
        if let Some(next) = slow.get(block + 1) {
            product += self.upper(block) * next;
        }
        if let Some(before) = block.checked_sub(1) {
            product += self.upper(before).tr_mul(&slow[before]);
        }
        product
    }
}
