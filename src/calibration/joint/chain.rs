//! The parts of a drive and what is constant over all of them: which constants, and which slow changes, explain the parts
//! best, and how certain that is.
//!
//! Each part has its information about its own unknowns and about the next part's ([`super::band`]). These move with the
//! constants θ and with slow states s of the part ([`super::unknowns::moves`]). Priors: constants have theirs; stations
//! and clocks walk randomly from part to part; ranges wander as an Ornstein–Uhlenbeck process. The slow states are
//! eliminated along the chain, as in a Kalman smoother (Rauch, Tung & Striebel 1965).

use nalgebra::{Cholesky, Const, SMatrix};

use super::band::{PART, Part};
use super::unknowns::{CONSTANTS, Constants, SLOW, SLOW_CLOCKS, SLOW_RANGES};

type SlowMatrix = SMatrix<f64, SLOW, SLOW>;
type Between = SMatrix<f64, SLOW, CONSTANTS>;
type Square = SMatrix<f64, CONSTANTS, CONSTANTS>;

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
    /// The same of their clocks (s²).
    pub clocks_s2: f64,
    pub wander: Wander,
    /// Parts before which something happened that no prior expects.
    pub steps: Vec<usize>,
}

/// One part, linear about where everything is taken to be.
pub struct Link<'a> {
    pub part: &'a Part,
    /// Whether the next part belongs to the same stretch.
    pub tied_to_next: bool,
    pub by_constants: &'a SMatrix<f64, PART, CONSTANTS>,
    pub by_slow: &'a SMatrix<f64, PART, SLOW>,
}

/// A right-hand side, or a solution: `K` columns for each part's slow states and for the constants.
#[derive(Clone, Debug)]
pub struct Columns<const K: usize> {
    pub slow: Vec<SMatrix<f64, SLOW, K>>,
    pub constants: SMatrix<f64, CONSTANTS, K>,
}

impl<const K: usize> Columns<K> {
    pub fn zeros(parts: usize) -> Self {
        Self { slow: vec![SMatrix::zeros(); parts], constants: SMatrix::zeros() }
    }

    pub fn dot<const L: usize>(&self, other: &Columns<L>) -> SMatrix<f64, K, L> {
        let of_slow = self.slow.iter().zip(&other.slow).map(|(a, b)| a.tr_mul(b));
        of_slow.fold(self.constants.tr_mul(&other.constants), |sum, part| sum + part)
    }
}

/// The priors of the slow states as precisions: of each, and of each with the next one.
pub struct SlowPrecisions {
    own: Vec<SlowMatrix>,
    with_next: Vec<SlowMatrix>,
    log_determinant: f64,
}

impl SlowPrecisions {
    /// Of parts at these times (s); `None` where something is known exactly.
    pub fn new(priors: &SlowPriors, time_s: &[f64]) -> Option<Self> {
        let whole_s = (time_s.last()? - time_s.first()?).max(1.0);
        let settled = priors.settling.cholesky()?;
        let (settling, settled) = (settled.inverse(), 2.0 * settled.ln_determinant_of_root());
        let mut own = vec![SlowMatrix::zeros(); time_s.len()];
        let mut with_next = vec![SlowMatrix::zeros(); time_s.len()];
        let mut log_determinant = 0.0;
        let variance_m2 = priors.wander.sigma_m.powi(2);
        for part in 0..time_s.len() {
            let since_s = match part {
                // From the set-up to the first part.
                0 => 0.5 * whole_s / time_s.len() as f64,
                _ => time_s[part] - time_s[part - 1],
            };
            let mut share = (since_s / whole_s).max(1e-4);
            if priors.steps.contains(&part) {
                share = STEP;
            }
            let mut step = SlowMatrix::zeros();
            step.fixed_view_mut::<8, 8>(0, 0).copy_from(&(settling / share));
            for clock in SLOW_CLOCKS..SLOW_RANGES {
                step[(clock, clock)] = 1.0 / (share * priors.clocks_s2);
            }
            own[part] += step;
            log_determinant -= settled + 8.0 * share.ln() + 2.0 * (share * priors.clocks_s2).ln();
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
        Some(Self { own, with_next, log_determinant })
    }

    /// As if slow states were known a thousand times better.
    pub fn stiffer(&self) -> Self {
        let more = |all: &[SlowMatrix]| all.iter().map(|matrix| matrix * 1e6).collect();
        let log_determinant = self.log_determinant;
        Self { own: more(&self.own), with_next: more(&self.with_next), log_determinant }
    }

    /// Times slow states.
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

trait LnDeterminant {
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

/// What the data says of the constants and the slow states, without any prior.
pub struct Data {
    own: Vec<SlowMatrix>,
    with_next: Vec<SlowMatrix>,
    with_constants: Vec<Between>,
    pub constants: Square,
    pub gradient: Columns<1>,
}

impl Data {
    pub fn of(links: &[Link<'_>]) -> Self {
        let mut constants = Square::zeros();
        let mut gradient = Columns::zeros(links.len());
        let (mut own, mut with_next, mut with_constants) = (Vec::new(), Vec::new(), Vec::new());
        for (index, link) in links.iter().enumerate() {
            // Products with a transpose that is written out are several times faster than `tr_mul`.
            let by_slow = link.by_slow.transpose();
            let mut moved = link.part.information * link.by_constants;
            let mut coupling = SlowMatrix::zeros();
            if link.tied_to_next {
                let next = &links[index + 1];
                moved += link.part.with_next * next.by_constants;
                coupling = by_slow * (link.part.with_next * next.by_slow);
            }
            if let Some(before) = index.checked_sub(1).map(|i| &links[i]).filter(|l| l.tied_to_next)
            {
                moved += before.part.with_next.transpose() * before.by_constants;
            }
            constants += link.by_constants.transpose() * moved;
            own.push(by_slow * (link.part.information * link.by_slow));
            with_next.push(coupling);
            with_constants.push(by_slow * moved);
            gradient.constants += link.by_constants.tr_mul(&link.part.gradient);
            gradient.slow[index] = link.by_slow.tr_mul(&link.part.gradient);
        }
        // Rounding must not make it lopsided.
        let constants = 0.5 * (constants + constants.transpose());
        Self { own, with_next, with_constants, constants, gradient }
    }

    /// Times a solution.
    pub fn times<const K: usize>(&self, columns: &Columns<K>) -> Columns<K> {
        let mut product = Columns::zeros(self.own.len());
        product.constants = self.constants * columns.constants;
        for part in 0..self.own.len() {
            product.constants += self.with_constants[part].tr_mul(&columns.slow[part]);
            let slow = &mut product.slow[part];
            *slow =
                self.with_constants[part] * columns.constants + self.own[part] * columns.slow[part];
            if part + 1 < self.own.len() {
                *slow += self.with_next[part] * columns.slow[part + 1];
            }
            if part > 0 {
                *slow += self.with_next[part - 1].tr_mul(&columns.slow[part - 1]);
            }
        }
        product
    }
}

/// Data and priors, factorised.
pub struct Factor {
    own: Vec<SlowMatrix>,
    with_next: Vec<SlowMatrix>,
    with_constants: Vec<Between>,
    constants: Cholesky<f64, Const<CONSTANTS>>,
    /// Logarithm of the determinant, less the one of the slow priors.
    pub log_determinant: f64,
}

impl Factor {
    /// `None` where a direction stays free.
    pub fn new(data: &Data, precision: &Constants, priors: &SlowPrecisions) -> Option<Self> {
        let parts = data.own.len();
        let (mut own, mut with_next) = (Vec::with_capacity(parts), Vec::with_capacity(parts));
        let mut with_constants = Vec::with_capacity(parts);
        let mut constants = data.constants + Square::from_diagonal(precision);
        let mut log_determinant = -priors.log_determinant;
        let (mut carried, mut carried_constants) = (SlowMatrix::zeros(), Between::zeros());
        for part in 0..parts {
            let block = data.own[part] + priors.own[part] - carried;
            let root = block.cholesky()?;
            log_determinant += 2.0 * root.ln_determinant_of_root();
            let lower = root.unpack();
            let next =
                lower.solve_lower_triangular(&(data.with_next[part] + priors.with_next[part]))?;
            let border =
                lower.solve_lower_triangular(&(data.with_constants[part] - carried_constants))?;
            let back = next.transpose();
            carried = back * next;
            carried_constants = back * border;
            constants -= border.transpose() * border;
            own.push(lower);
            with_next.push(next);
            with_constants.push(border);
        }
        let constants = constants.cholesky()?;
        log_determinant += 2.0 * constants.ln_determinant_of_root();
        log_determinant.is_finite().then_some(Self {
            own,
            with_next,
            with_constants,
            constants,
            log_determinant,
        })
    }

    pub fn solve<const K: usize>(&self, right: &Columns<K>) -> Columns<K> {
        let parts = self.own.len();
        let mut solution = right.clone();
        let mut constants = right.constants;
        for part in 0..parts {
            if part > 0 {
                let before = self.with_next[part - 1].tr_mul(&solution.slow[part - 1]);
                solution.slow[part] -= before;
            }
            self.own[part].solve_lower_triangular_mut(&mut solution.slow[part]);
            constants -= self.with_constants[part].tr_mul(&solution.slow[part]);
        }
        solution.constants = self.constants.solve(&constants);
        for part in (0..parts).rev() {
            let mut value = solution.slow[part] - self.with_constants[part] * solution.constants;
            if part + 1 < parts {
                value -= self.with_next[part] * solution.slow[part + 1];
            }
            self.own[part].tr_solve_lower_triangular_mut(&mut value);
            solution.slow[part] = value;
        }
        solution
    }
}
