//! What is known of slow changes beforehand: stations and clocks walk randomly from part to part, and ranges wander as an
//! Ornstein–Uhlenbeck process.

use nalgebra::{Cholesky, Const, SMatrix};

use super::unknowns::{SLOW, SLOW_CLOCKS, SLOW_RANGES};

pub type SlowMatrix = SMatrix<f64, SLOW, SLOW>;
/// A matrix of the states that walk: stations and clocks.
pub type Walk = SMatrix<f64, SLOW_RANGES, SLOW_RANGES>;

/// Steps that were found are taken to be this many times the variance of a whole drive.
const STEP: f64 = 1e4;

/// How ranges wander: one standard deviation (m) of a process that forgets within some seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wander {
    pub sigma_m: f64,
    pub correlation_s: f64,
}

/// What is known of slow changes beforehand.
#[derive(Clone, Debug)]
pub struct SlowPriors {
    /// Variance of how far (x, y, z, yaw) of stations 2 and 3 walk during the whole drive (m², rad²).
    pub settling: SMatrix<f64, 8, 8>,
    /// Variance of how far the clocks of stations 2 and 3 walk during the whole drive (s²).
    pub clocks_s2: f64,
    pub wander: Wander,
    /// When further drives begin (s): stations may have settled since as during a drive, and clocks are their own, with
    /// this variance (s²).
    pub restarts_s: Vec<f64>,
    pub restarted_s2: f64,
    /// Parts before which stations, or clocks, did what no prior expects.
    pub station_steps: Vec<usize>,
    pub clock_steps: Vec<usize>,
}

/// The priors of the slow states as precisions: of each, and of each with the next one.
pub struct SlowPrecisions {
    pub own: Vec<SlowMatrix>,
    pub with_next: Vec<SlowMatrix>,
    pub log_determinant: f64,
    /// How much of what a whole drive settles by has settled until each part, where nothing steps.
    pub settled_shares: Vec<f64>,
}

impl SlowPrecisions {
    /// Precisions of the slow states of parts at these times (s); `None` where something is known exactly.
    pub fn new(priors: &SlowPriors, time_s: &[f64]) -> Option<Self> {
        let restarts = |part: usize| {
            part > 0
                && priors.restarts_s.iter().any(|at| (time_s[part - 1]..time_s[part]).contains(at))
        };
        let paused_s: f64 = (0..time_s.len())
            .filter(|part| restarts(*part))
            .map(|part| time_s[part] - time_s[part - 1])
            .sum();
        let drives = (priors.restarts_s.len() + 1) as f64;
        // A whole drive.
        let whole_s = ((time_s.last()? - time_s.first()? - paused_s) / drives).max(1.0);
        let settled = priors.settling.cholesky()?;
        let (settling, settled) = (settled.inverse(), 2.0 * settled.ln_determinant_of_root());
        let mut own = vec![SlowMatrix::zeros(); time_s.len()];
        let mut with_next = vec![SlowMatrix::zeros(); time_s.len()];
        let mut log_determinant = 0.0;
        let variance_m2 = priors.wander.sigma_m.powi(2);
        let mut settled_shares = Vec::with_capacity(time_s.len());
        for part in 0..time_s.len() {
            let since_s = match part {
                // From the set-up to the first part.
                0 => 0.5 * whole_s * drives / time_s.len() as f64,
                _ => time_s[part] - time_s[part - 1],
            };
            let usual = if restarts(part) { 1.0 } else { (since_s / whole_s).max(1e-4) };
            settled_shares.push(settled_shares.last().unwrap_or(&0.0) + usual);
            let share = |steps: &[usize]| if steps.contains(&part) { STEP } else { usual };
            let (stations, clocks) = (share(&priors.station_steps), share(&priors.clock_steps));
            let clocks_s2 =
                if restarts(part) { priors.restarted_s2 } else { clocks * priors.clocks_s2 };
            let mut step = SlowMatrix::zeros();
            step.fixed_view_mut::<8, 8>(0, 0).copy_from(&(settling / stations));
            for clock in SLOW_CLOCKS..SLOW_RANGES {
                step[(clock, clock)] = clocks_s2.recip();
            }
            own[part] += step;
            log_determinant -= settled + 8.0 * stations.ln() + 2.0 * clocks_s2.ln();
            let kept = if part == 0 { 0.0 } else { (-since_s / priors.wander.correlation_s).exp() };
            let fresh = 1.0 / (variance_m2 * (1.0 - kept * kept).max(1e-6));
            for range in SLOW_RANGES..SLOW {
                own[part][(range, range)] += fresh;
                log_determinant += fresh.ln();
            }
            if part > 0 {
                own[part - 1] += step;
                with_next[part - 1] -= step;
                for range in SLOW_RANGES..SLOW {
                    own[part - 1][(range, range)] += kept * kept * fresh;
                    with_next[part - 1][(range, range)] -= kept * fresh;
                }
            }
        }
        Some(Self { own, with_next, log_determinant, settled_shares })
    }

    /// Gives its room away.
    pub fn forget(&mut self) {
        (self.own, self.with_next) = (Vec::new(), Vec::new());
    }

    /// Precisions as if slow states were known a thousand times better.
    pub fn stiffer(&self) -> Self {
        let more = |all: &[SlowMatrix]| all.iter().map(|matrix| matrix * 1e6).collect();
        Self {
            own: more(&self.own),
            with_next: more(&self.with_next),
            log_determinant: self.log_determinant,
            settled_shares: self.settled_shares.clone(),
        }
    }

    /// Precision of how stations 2 and 3 and their clocks walk to a part from the one before it.
    pub fn of_walk(&self, part: usize) -> Walk {
        -self.with_next[part - 1].fixed_view::<SLOW_RANGES, SLOW_RANGES>(0, 0)
    }

    /// Precision of how all that walks from the first part to the last; `None` where that is known exactly.
    pub fn of_whole_walk(&self) -> Option<Walk> {
        let mut covariance = Walk::zeros();
        for part in 1..self.own.len() {
            covariance += self.of_walk(part).cholesky()?.inverse();
        }
        Some(covariance.cholesky()?.inverse())
    }

    /// The product of the precisions and slow states.
    pub fn times<const K: usize>(
        &self,
        slow: &[SMatrix<f64, SLOW, K>],
    ) -> Vec<SMatrix<f64, SLOW, K>> {
        (0..slow.len())
            .map(|part| {
                let mut product = self.own[part] * slow[part];
                if part + 1 < slow.len() {
                    product += self.with_next[part] * slow[part + 1];
                }
                if part > 0 {
                    product += self.with_next[part - 1].tr_mul(&slow[part - 1]);
                }
                product
            })
            .collect()
    }
}

/// What a product of variances is compared by.
pub trait LnDeterminant {
    /// Logarithm of the determinant of the triangular root.
    fn ln_determinant_of_root(&self) -> f64;
}

impl<const N: usize> LnDeterminant for Cholesky<f64, Const<N>>
where
    Const<N>: nalgebra::DimMin<Const<N>>,
{
    fn ln_determinant_of_root(&self) -> f64 {
        let root = self.l_dirty();
        (0..N).map(|i| root[(i, i)].ln()).sum()
    }
}
