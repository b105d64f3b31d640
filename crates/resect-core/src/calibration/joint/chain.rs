//! The parts of a drive as a chain: what the data says of what is constant over all of them, and of what changes slowly.
//!
//! Each part has its information about its own unknowns and about the next part's ([`super::band`]). These move with the
//! constants θ and with slow states s of the part ([`super::unknowns::moves`]). What that says of θ and s takes twice the room
//! of the parts: that of a long drive is made from them, some parts at a time, whenever it is asked for.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::SMatrix;
use rayon::prelude::*;

use super::band::{Part, PartVector};
use super::moves::Moves;
use super::slow_priors::SlowMatrix;
use super::unknowns::{CONSTANTS, SLOW};

/// Slow states with constants, and constants with each other.
pub type Between = SMatrix<f64, SLOW, CONSTANTS>;
pub type Square = SMatrix<f64, CONSTANTS, CONSTANTS>;

/// Parts whose blocks are made side by side, and whose factors are.
pub const AT_ONCE: usize = 256;
/// What is made of so many parts is kept (14 MB with the factor; two hours of a usual drive).
pub const MOST_KEPT_PARTS: usize = 4 * AT_ONCE;

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
}

/// What the data says of one part: of its slow states, of these with those of the next part, and with the constants.
#[derive(Clone, Debug)]
pub struct Block {
    pub own: SlowMatrix,
    pub with_next: SlowMatrix,
    pub with_constants: Between,
}

/// What the data says of the constants and the slow states, without any prior.
pub struct Data {
    /// Linear about where everything is taken to be.
    parts: Vec<Part>,
    pub moves: Moves,
    /// The rows of the first parts.
    kept: Vec<Block>,
    pub constants: Square,
}

/// What the data says about where everything is taken to be: its normal matrix, and its gradient there.
pub struct Linear {
    pub data: Arc<Data>,
    pub gradient: Columns<1>,
}

impl Data {
    pub fn new(parts: Vec<Part>, moves: Moves) -> Self {
        let mut data = Self { parts, moves, kept: Vec::new(), constants: Square::zeros() };
        for some in data.chunks() {
            let found: Vec<(Block, Square)> =
                some.clone().into_par_iter().map(|part| data.of_part(part)).collect();
            for (part, (block, constants)) in some.zip(found) {
                data.constants += constants;
                if part < MOST_KEPT_PARTS {
                    data.kept.push(block);
                }
            }
        }
        // Rounding must not make it lopsided.
        data.constants = 0.5 * (data.constants + data.constants.transpose());
        data
    }

    /// The number of parts.
    pub fn len(&self) -> usize {
        self.parts.len()
    }

    /// The parts in their order, some at a time.
    pub fn chunks(&self) -> impl DoubleEndedIterator<Item = Range<usize>> + use<> {
        let parts = self.len();
        (0..parts.div_ceil(AT_ONCE)).map(move |k| k * AT_ONCE..parts.min((k + 1) * AT_ONCE))
    }

    /// What the data says of some parts.
    pub fn blocks(&self, parts: Range<usize>) -> Cow<'_, [Block]> {
        match self.kept.get(parts.clone()) {
            Some(kept) => Cow::Borrowed(kept),
            None => parts.into_par_iter().map(|part| self.of_part(part).0).collect(),
        }
    }

    /// A part's block, and what it says of the constants.
    fn of_part(&self, index: usize) -> (Block, Square) {
        let part = &self.parts[index];
        // Products with a transpose that is written out are several times faster than `tr_mul`.
        let (own_by_constants, own_by_slow) = self.moves.of(index);
        let (by_slow, by_constants) = (own_by_slow.transpose(), own_by_constants.transpose());
        let mut pulled = part.information * own_by_constants;
        let mut with_next = SlowMatrix::zeros();
        if self.moves.ties_to_next(index) {
            let (next_by_constants, next_by_slow) = self.moves.of(index + 1);
            pulled += part.with_next * next_by_constants;
            with_next = by_slow * (part.with_next * next_by_slow);
        }
        if let Some(before) = index.checked_sub(1).filter(|before| self.moves.ties_to_next(*before))
        {
            pulled += self.parts[before].with_next.transpose() * self.moves.of(before).0;
        }
        let own = by_slow * (part.information * own_by_slow);
        (Block { own, with_next, with_constants: by_slow * pulled }, by_constants * pulled)
    }

    /// The parts' gradients where the data was made.
    pub fn gradients(&self) -> impl Iterator<Item = PartVector> {
        self.parts.iter().map(|part| part.gradient)
    }

    /// The gradient of constants and slow states, from the gradients of the parts.
    pub fn gradient(&self, of_parts: impl Iterator<Item = PartVector>) -> Columns<1> {
        let mut gradient = Columns::zeros(self.len());
        for (index, of_part) in of_parts.enumerate() {
            let (by_constants, by_slow) = self.moves.of(index);
            gradient.slow[index] = by_slow.tr_mul(&of_part);
            gradient.constants += by_constants.tr_mul(&of_part);
        }
        gradient
    }

    /// The squares of solutions by this normal matrix, `XᵀHX`.
    pub fn squares<const K: usize>(&self, columns: &Columns<K>) -> SMatrix<f64, K, K> {
        let constants = &columns.constants;
        let mut sum = constants.tr_mul(&(self.constants * constants));
        for some in self.chunks() {
            for (part, block) in some.clone().zip(self.blocks(some).iter()) {
                let slow = &columns.slow[part];
                let mut across = block.with_constants * constants;
                if let Some(next) = columns.slow.get(part + 1) {
                    across += block.with_next * next;
                }
                let across = slow.tr_mul(&across);
                sum += slow.tr_mul(&(block.own * slow)) + across + across.transpose();
            }
        }
        sum
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The same data, of which nothing is kept that can be made again.
    pub fn without_kept(data: &Data) -> Data {
        let (parts, moves) = (data.parts.clone(), data.moves.clone());
        Data { parts, moves, kept: Vec::new(), constants: data.constants }
    }
}
