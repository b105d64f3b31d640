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

/// The priors of the slow states as precisions. Their matrices are made whenever they are asked for: kept, those of a long
/// drive would take more room than its readings.
#[derive(Clone)]
pub struct SlowPrecisions {
    /// Precision of how stations 2 and 3 walk during a whole drive.
    settling: SMatrix<f64, 8, 8>,
    comings: Vec<Coming>,
    pub log_determinant: f64,
}

/// How the states of a part come from those of the part before it, or of the first from the set-up.
#[derive(Clone, Copy)]
struct Coming {
    /// The share of a whole drive's variance that stations walk by, and the one where nothing steps.
    stations: f64,
    usual: f64,
    /// Precision of how each clock walks (1/s²).
    clocks: f64,
    /// The share of the ranges' errors that stays, and the precision of what is new (1/m²).
    kept: f64,
    fresh: f64,
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
        let mut log_determinant = 0.0;
        let variance_m2 = priors.wander.sigma_m.powi(2);
        let coming = |part: usize| {
            let since_s = match part {
                // From the set-up to the first part.
                0 => 0.5 * whole_s * drives / time_s.len() as f64,
                _ => time_s[part] - time_s[part - 1],
            };
            let usual = if restarts(part) { 1.0 } else { (since_s / whole_s).max(1e-4) };
            let share = |steps: &[usize]| if steps.contains(&part) { STEP } else { usual };
            let (stations, clocks) = (share(&priors.station_steps), share(&priors.clock_steps));
            let clocks_s2 =
                if restarts(part) { priors.restarted_s2 } else { clocks * priors.clocks_s2 };
            log_determinant -= settled + 8.0 * stations.ln() + 2.0 * clocks_s2.ln();
            let kept = if part == 0 { 0.0 } else { (-since_s / priors.wander.correlation_s).exp() };
            let fresh = 1.0 / (variance_m2 * (1.0 - kept * kept).max(1e-6));
            for _ in SLOW_RANGES..SLOW {
                log_determinant += fresh.ln();
            }
            Coming { stations, usual, clocks: clocks_s2.recip(), kept, fresh }
        };
        let comings = (0..time_s.len()).map(coming).collect();
        Some(Self { settling, comings, log_determinant })
    }

    /// Precisions as if slow states were known a thousand times better.
    pub fn stiffer(&self) -> Self {
        const MORE: f64 = 1e6;
        let stiffer = |coming: &Coming| Coming {
            clocks: coming.clocks * MORE,
            fresh: coming.fresh * MORE,
            ..*coming
        };
        let comings = self.comings.iter().map(stiffer).collect();
        Self { settling: self.settling * MORE, comings, log_determinant: self.log_determinant }
    }

    /// Precision of a part's own states.
    pub fn own(&self, part: usize) -> SlowMatrix {
        let (to, next) = (self.comings[part], self.comings.get(part + 1));
        let mut own = SlowMatrix::zeros();
        let mut walk = self.of_walk(part);
        let mut fresh = to.fresh;
        if let Some(next) = next {
            walk += self.of_walk(part + 1);
            fresh += next.kept * next.kept * next.fresh;
        }
        own.fixed_view_mut::<SLOW_RANGES, SLOW_RANGES>(0, 0).copy_from(&walk);
        (SLOW_RANGES..SLOW).for_each(|range| own[(range, range)] = fresh);
        own
    }

    /// What a part's states have in common with those of the part after it.
    pub fn with_next(&self, part: usize) -> SlowMatrix {
        let mut both = SlowMatrix::zeros();
        let Some(next) = self.comings.get(part + 1) else { return both };
        let walk = -self.of_walk(part + 1);
        both.fixed_view_mut::<SLOW_RANGES, SLOW_RANGES>(0, 0).copy_from(&walk);
        (SLOW_RANGES..SLOW).for_each(|range| both[(range, range)] = -next.kept * next.fresh);
        both
    }

    /// Precision of how stations 2 and 3 and their clocks walk to a part from the one before it.
    pub fn of_walk(&self, part: usize) -> Walk {
        let to = self.comings[part];
        let mut walk = Walk::zeros();
        walk.fixed_view_mut::<8, 8>(0, 0).copy_from(&(self.settling / to.stations));
        (SLOW_CLOCKS..SLOW_RANGES).for_each(|clock| walk[(clock, clock)] = to.clocks);
        walk
    }

    /// Precision of how all that walks from the first part to the last; `None` where that is known exactly.
    pub fn of_whole_walk(&self) -> Option<Walk> {
        let mut covariance = Walk::zeros();
        for part in 1..self.comings.len() {
            covariance += self.of_walk(part).cholesky()?.inverse();
        }
        Some(covariance.cholesky()?.inverse())
    }

    /// How much of what a whole drive settles by has settled until each part, where nothing steps.
    pub fn settled_shares(&self) -> Vec<f64> {
        let mut settled = 0.0;
        let until = |coming: &Coming| {
            settled += coming.usual;
            settled
        };
        self.comings.iter().map(until).collect()
    }

    /// The product of the precisions and slow states, of one part.
    pub fn pull<const K: usize>(
        &self,
        slow: &[SMatrix<f64, SLOW, K>],
        part: usize,
    ) -> SMatrix<f64, SLOW, K> {
        let mut pull = self.own(part) * slow[part];
        if let Some(next) = slow.get(part + 1) {
            pull += self.with_next(part) * next;
        }
        if let Some(before) = part.checked_sub(1) {
            pull += self.with_next(before).tr_mul(&slow[before]);
        }
        pull
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
