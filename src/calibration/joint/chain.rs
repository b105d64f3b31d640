//! The parts of a drive as a chain: what the data says of what is constant over all of them, and of what changes slowly.
//!
//! Each part has its information about its own unknowns and about the next part's ([`super::band`]). These move with the
//! constants θ and with slow states s of the part ([`super::unknowns::moves`]).

use nalgebra::SMatrix;
use rayon::prelude::*;

use super::band::Part;
use super::moves::Moved;
use super::slow_priors::SlowMatrix;
use super::unknowns::{CONSTANTS, Constants, SLOW, Slow};

/// Slow states with constants, and constants with each other.
pub type Between = SMatrix<f64, SLOW, CONSTANTS>;
pub type Square = SMatrix<f64, CONSTANTS, CONSTANTS>;

/// Parts whose sums are made side by side.
const AT_ONCE: usize = 512;

/// One part, linear about where everything is taken to be.
pub struct Link<'a> {
    pub part: &'a Part,
    /// Whether the next part belongs to the same stretch.
    pub tied_to_next: bool,
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

/// What the data says of the constants and the slow states, without any prior.
pub struct Data {
    pub own: Vec<SlowMatrix>,
    pub with_next: Vec<SlowMatrix>,
    pub with_constants: Vec<Between>,
    pub constants: Square,
    pub gradient: Columns<1>,
}

/// What the data says of one part.
struct OfPart {
    own: SlowMatrix,
    with_next: SlowMatrix,
    with_constants: Between,
    constants: Square,
    gradient: (Slow, Constants),
}

impl Data {
    pub fn of(links: &[Link<'_>], moved: impl Fn(usize) -> Moved + Sync) -> Self {
        let one = |index: usize| {
            let link = &links[index];
            // Products with a transpose that is written out are several times faster than `tr_mul`.
            let (own_by_constants, own_by_slow) = moved(index);
            let (by_slow, by_constants) = (own_by_slow.transpose(), own_by_constants.transpose());
            let mut pulled = link.part.information * own_by_constants;
            let mut coupling = SlowMatrix::zeros();
            if link.tied_to_next {
                let (next_by_constants, next_by_slow) = moved(index + 1);
                pulled += link.part.with_next * next_by_constants;
                coupling = by_slow * (link.part.with_next * next_by_slow);
            }
            if let Some(before) = index.checked_sub(1).filter(|before| links[*before].tied_to_next)
            {
                pulled += links[before].part.with_next.transpose() * moved(before).0;
            }
            OfPart {
                own: by_slow * (link.part.information * own_by_slow),
                with_next: coupling,
                with_constants: by_slow * pulled,
                constants: by_constants * pulled,
                gradient: (by_slow * link.part.gradient, by_constants * link.part.gradient),
            }
        };
        let mut data = Self {
            own: Vec::with_capacity(links.len()),
            with_next: Vec::with_capacity(links.len()),
            with_constants: Vec::with_capacity(links.len()),
            constants: Square::zeros(),
            gradient: Columns::zeros(links.len()),
        };
        // Some at a time: what all say of the constants would take as much room as all the rest.
        let indices: Vec<usize> = (0..links.len()).collect();
        let some = indices.chunks(AT_ONCE);
        let parts =
            some.flat_map(|some| some.par_iter().map(|index| one(*index)).collect::<Vec<_>>());
        for (index, part) in parts.enumerate() {
            data.own.push(part.own);
            data.with_next.push(part.with_next);
            data.with_constants.push(part.with_constants);
            data.constants += part.constants;
            data.gradient.slow[index] = part.gradient.0;
            data.gradient.constants += part.gradient.1;
        }
        // Rounding must not make it lopsided.
        data.constants = 0.5 * (data.constants + data.constants.transpose());
        data
    }

    /// Another gradient, by part about slow states and constants.
    pub fn exchange_gradient(&mut self, parts: impl Iterator<Item = (Slow, Constants)>) {
        self.gradient.constants.fill(0.0);
        for (own, (slow, constants)) in self.gradient.slow.iter_mut().zip(parts) {
            *own = slow;
            self.gradient.constants += constants;
        }
    }

    /// The product of this normal matrix and a solution.
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
