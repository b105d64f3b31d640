//! Priors of the slow states: poses and clocks of stations are random walks from block to block, and errors of the sights are
//! Gauss–Markov processes.

use nalgebra::SMatrix;

use super::state_vector::{SLOW, SLOW_ACROSS, SLOW_CLOCKS, SLOW_RANGES};

pub type SlowMatrix = SMatrix<f64, SLOW, SLOW>;
/// A matrix of the states that are random walks: poses of stations 2 and 3, and their clocks.
pub type WalkMatrix = SMatrix<f64, SLOW_RANGES, SLOW_RANGES>;

/// Variance of a detected step, as a multiple of that of a whole drive.
const STEP_MULTIPLE: f64 = 1e4;

/// A Gauss–Markov process of the first order: standard deviation (m) and correlation time (s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussMarkov {
    pub sigma_m: f64,
    pub correlation_s: f64,
}

impl GaussMarkov {
    /// Practically no error, for settings without slow errors (m, s).
    pub const NONE: Self = Self { sigma_m: 1e-4, correlation_s: PROCESS_TIMES_S[1] };
    /// The smallest process that is tried, with which the estimate starts (m, s).
    pub const SMALLEST: Self =
        Self { sigma_m: PROCESS_SIGMAS_M[0], correlation_s: PROCESS_TIMES_S[1] };
}

/// Standard deviations of slow errors that are tried. Several stations see different facets of a prism, so no drive has smaller
/// errors. Measured: on real drives they are 0.5 to 1.5 mm.
pub const PROCESS_SIGMAS_M: [f64; 5] = [8e-4, 0.0014, 0.0025, 0.0045, 0.008];
/// Correlation times of slow errors that are tried.
pub const PROCESS_TIMES_S: [f64; 4] = [3.0, 12.0, 50.0, 200.0];

/// Priors of the slow states.
#[derive(Clone, Debug)]
pub struct SlowPriors {
    /// Variance of the random walks of (x, y, z, yaw) of stations 2 and 3 over a whole drive (m², rad²).
    pub settling: SMatrix<f64, 8, 8>,
    /// Variance of the random walks of the clocks of stations 2 and 3 over a whole drive (s²).
    pub clocks_s2: f64,
    /// Errors of the ranges, of the sights across, and upward.
    pub ranges: GaussMarkov,
    pub across: GaussMarkov,
    pub upward: GaussMarkov,
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
    /// Errors of the ranges, of the sights across, and upward.
    processes: [Innovation; 3],
}

/// Correlation of an error with that of the block before, and precision of its innovation (1/m²).
#[derive(Clone, Copy)]
struct Innovation {
    correlation: f64,
    precision: f64,
}

impl Innovation {
    /// The innovation after a time (s); `None` for the first block.
    fn new(process: &GaussMarkov, since_s: Option<f64>) -> Self {
        // (11)
        let correlation = since_s.map_or(0.0, |since_s| (-since_s / process.correlation_s).exp());
        let share = (1.0 - correlation * correlation).max(1e-6);
        Self { correlation, precision: 1.0 / (process.sigma_m.powi(2) * share) }
    }
}

/// The process of a slow state from [`SLOW_RANGES`] on.
fn process(state: usize) -> usize {
    state.checked_sub(SLOW_ACROSS).map_or(0, |beyond| 1 + beyond % 2)
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
            let since_s = (block > 0).then_some(since_s);
            let processes = [&priors.ranges, &priors.across, &priors.upward]
                .map(|it| Innovation::new(it, since_s));
            for state in SLOW_RANGES..SLOW {
                ln_determinant += processes[process(state)].precision.ln();
            }
            Transition {
                pose_share,
                share_without_step,
                clock_precision: clocks_s2.recip(),
                processes,
            }
        };
        let transitions = (0..time_s.len()).map(transition).collect();
        Some(Self { settling, transitions, ln_determinant })
    }

    /// The precision for standard deviations a thousand times smaller.
    pub fn stiffer(&self) -> Self {
        /// Factor of the precision of all slow states where these are unobservable.
        const MORE: f64 = 1e6;
        let stiffer = |transition: &Transition| Transition {
            clock_precision: transition.clock_precision * MORE,
            processes: transition.processes.map(|innovation| Innovation {
                precision: innovation.precision * MORE,
                ..innovation
            }),
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
        if next.is_some() {
            walk += self.increment_precision(block + 1);
        }
        own.fixed_view_mut::<SLOW_RANGES, SLOW_RANGES>(0, 0).copy_from(&walk);
        for state in SLOW_RANGES..SLOW {
            let from_next = next.map_or(0.0, |next| {
                let Innovation { correlation, precision } = next.processes[process(state)];
                correlation * correlation * precision
            });
            own[(state, state)] = transition.processes[process(state)].precision + from_next;
        }
        own
    }

    /// Block of the precision matrix right of the diagonal.
    pub fn upper(&self, block: usize) -> SlowMatrix {
        let mut both = SlowMatrix::zeros();
        let Some(next) = self.transitions.get(block + 1) else { return both };
        let walk = -self.increment_precision(block + 1);
        both.fixed_view_mut::<SLOW_RANGES, SLOW_RANGES>(0, 0).copy_from(&walk);
        for state in SLOW_RANGES..SLOW {
            let Innovation { correlation, precision } = next.processes[process(state)];
            both[(state, state)] = -correlation * precision;
        }
        both
    }

    /// Precision of the random walks' increment to a block from the one before it.
    pub fn increment_precision(&self, block: usize) -> WalkMatrix {
        // (10)
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
