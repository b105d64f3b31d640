//! Priors of the slow states: poses and clocks of stations are random walks from block to block, and errors of the sights are
//! Gauss–Markov processes.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::drive::Drive;
use super::state_vector::{Layout, Slow};
use crate::linear_algebra::bordered_rows::RowShape;

pub type SlowMatrix = DMatrix<f64>;
/// A matrix of the states that are random walks: poses by slot, and clocks by slot.
pub type WalkMatrix = DMatrix<f64>;

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
    /// Variance of the random walks of (x, y, z, yaw) by slot over a whole drive (m², rad²).
    pub settling: DMatrix<f64>,
    /// Variance of the random walk of each clock over a whole drive (s²).
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
    layout: Arc<Layout>,
    /// Precision of the random walk of the poses over a whole drive.
    settling: DMatrix<f64>,
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

impl SlowPrecisions {
    /// The precision for the blocks of a drive; `None` if a variance is not positive.
    pub fn of_drive(priors: &SlowPriors, drive: &Drive) -> Option<Self> {
        Self::new(priors, &drive.layout, &drive.block_times_s)
    }

    /// The precision for blocks at these times (s); `None` if a variance is not positive.
    pub fn new(priors: &SlowPriors, layout: &Arc<Layout>, time_s: &[f64]) -> Option<Self> {
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
        let factor = priors.settling.clone().cholesky()?;
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
            let slots = layout.moved() as f64;
            ln_determinant -= ln_settling + 4.0 * slots * pose_share.ln() + slots * clocks_s2.ln();
            let since_s = (block > 0).then_some(since_s);
            let processes = [&priors.ranges, &priors.across, &priors.upward]
                .map(|it| Innovation::new(it, since_s));
            for state in layout.slow_ranges()..layout.slow() {
                ln_determinant += processes[process(layout, state)].precision.ln();
            }
            Transition {
                pose_share,
                share_without_step,
                clock_precision: clocks_s2.recip(),
                processes,
            }
        };
        let transitions = (0..time_s.len()).map(transition).collect();
        Some(Self { layout: Arc::clone(layout), settling, transitions, ln_determinant })
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
        Self { settling: &self.settling * MORE, transitions, ..self.clone() }
    }

    /// Adds the precisions of a block, and of its increment to the next one, to the block row of a normal matrix.
    pub fn add_to_row(&self, block: usize, row: &mut [f64], shape: RowShape) {
        let (transition, next) = (&self.transitions[block], self.transitions.get(block + 1));
        let poses = self.settling.nrows();
        let after = next.map_or(0.0, |next| next.pose_share.recip());
        let both = transition.pose_share.recip() + after;
        for (state, row) in row.chunks_exact_mut(shape.width()).enumerate() {
            let (diagonal, upper) = row.split_at_mut(shape.size);
            if state < poses {
                let precisions = self.settling.column(state);
                for ((diagonal, upper), precision) in
                    diagonal.iter_mut().zip(upper).zip(&precisions)
                {
                    *diagonal += both * precision;
                    *upper -= after * precision;
                }
                continue;
            }
            diagonal[state] += self.innovation(transition, state).precision;
            if let Some(next) = next {
                let Innovation { correlation, precision } = self.innovation(next, state);
                diagonal[state] += correlation * correlation * precision;
                upper[state] -= correlation * precision;
            }
        }
    }

    /// Innovation of a clock, whose correlation with the block before is one, or of an error of the sights.
    fn innovation(&self, transition: &Transition, state: usize) -> Innovation {
        if state < self.layout.slow_ranges() {
            Innovation { correlation: 1.0, precision: transition.clock_precision }
        } else {
            transition.processes[process(&self.layout, state)]
        }
    }

    fn add_walks(&self, transition: &Transition, factor: f64, matrix: &mut DMatrix<f64>) {
        // (10)
        let mut poses = matrix.view_mut((0, 0), self.settling.shape());
        poses += &self.settling * (factor / transition.pose_share);
        for clock in self.layout.slow_clocks()..self.layout.slow_ranges() {
            matrix[(clock, clock)] += factor * transition.clock_precision;
        }
    }

    /// Precision of the random walks' increment to a block from the one before it.
    pub fn increment_precision(&self, block: usize) -> WalkMatrix {
        let mut walk = WalkMatrix::zeros(self.layout.slow_ranges(), self.layout.slow_ranges());
        self.add_walks(&self.transitions[block], 1.0, &mut walk);
        walk
    }

    /// Precision of the random walks' increment from the first block to the last; `None` if it is singular.
    pub fn whole_drive_precision(&self) -> Option<WalkMatrix> {
        let mut covariance =
            WalkMatrix::zeros(self.layout.slow_ranges(), self.layout.slow_ranges());
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
    pub fn multiply(&self, slow: &[Slow], block: usize) -> Slow {
        let own = &slow[block];
        let (before, after) =
            (block.checked_sub(1).map(|before| &slow[before]), slow.get(block + 1));
        let (transition, next) = (&self.transitions[block], self.transitions.get(block + 1));
        let poses = self.settling.nrows();
        let increment = |state: usize| {
            let since = own[state] - before.map_or(0.0, |before| before[state]);
            let until = after
                .zip(next)
                .map_or(0.0, |(after, next)| (after[state] - own[state]) / next.pose_share);
            since / transition.pose_share - until
        };
        let increments = DVector::from_fn(poses, |state, _| increment(state));
        let mut product = Slow::zeros(own.len());
        product.rows_mut(0, poses).gemv(1.0, &self.settling, &increments, 0.0);
        for state in poses..own.len() {
            let Innovation { correlation, precision } = self.innovation(transition, state);
            let before = before.map_or(0.0, |before| correlation * before[state]);
            product[state] = precision * (own[state] - before);
            if let (Some(next), Some(after)) = (next, after) {
                let Innovation { correlation, precision } = self.innovation(next, state);
                product[state] -=
                    correlation * precision * (after[state] - correlation * own[state]);
            }
        }
        product
    }
}

/// The process of a slow state after the random walks: errors of the ranges, of the sights across, and upward.
fn process(layout: &Layout, state: usize) -> usize {
    state.checked_sub(layout.slow_across()).map_or(0, |beyond| 1 + beyond % 2)
}
