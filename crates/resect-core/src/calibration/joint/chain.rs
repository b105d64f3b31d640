//! Normal equations of the constants and slow states, once the motion is eliminated. They are a chain of blocks, each coupled to the next,
//! with the constants as border.
//!
//! Jacobians of [`super::block_jacobians`] transform the information `H_u` of the blocks' unknowns to θ and s. Diagonal blocks are
//! `J_sᵀ H_u J_s`, the border is `J_sᵀ H_u J_θ`, the corner `Σ J_θᵀ H_u J_θ`. These need twice the memory of the blocks, so those of a long
//! drive are recomputed, some blocks at a time.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::SMatrix;
use rayon::prelude::*;

use super::block_jacobians::BlockJacobians;
use super::drive::Drive;
use super::motion_band::BlockEquations;
use super::priors::Priors;
use super::random_walks::{SlowMatrix, SlowPrecisions};
use super::state_vector::{BlockVector, CONSTANTS, ConstantsMatrix, SLOW, StateVector};

/// A matrix of slow states by constants.
pub type SlowByConstants = SMatrix<f64, SLOW, CONSTANTS>;

/// Blocks that are computed in parallel.
pub const CHUNK: usize = 256;
/// Blocks whose rows are stored (11 MB with the factor; an hour of a usual drive).
pub const MOST_STORED_BLOCKS: usize = 2 * CHUNK;

/// `K` right-hand sides or solutions: rows for the slow states of each block, and for the constants.
#[derive(Clone, Debug)]
pub struct ChainVectors<const K: usize> {
    pub slow: Vec<SMatrix<f64, SLOW, K>>,
    pub constants: SMatrix<f64, CONSTANTS, K>,
}

impl<const K: usize> ChainVectors<K> {
    pub fn zeros(blocks: usize) -> Self {
        Self { slow: vec![SMatrix::zeros(); blocks], constants: SMatrix::zeros() }
    }

    /// The same columns times a factor.
    pub fn scaled(&self, factor: f64) -> Self {
        let slow = self.slow.iter().map(|slow| slow * factor).collect();
        Self { slow, constants: self.constants * factor }
    }
}

/// Block row of the normal matrix, from the data without the priors.
#[derive(Clone, Debug)]
pub struct ChainRow {
    pub diagonal: SlowMatrix,
    pub upper: SlowMatrix,
    pub border: SlowByConstants,
}

/// Normal matrix H of constants and slow states, from the data without the priors.
pub struct ChainMatrix {
    blocks: Vec<BlockEquations>,
    pub jacobians: BlockJacobians,
    /// Rows of the first blocks.
    stored: Vec<ChainRow>,
    /// The corner of the constants.
    pub constants: ConstantsMatrix,
}

/// Normal matrix and gradient at the linearisation point, from the data without the priors.
pub struct ChainEquations {
    pub matrix: Arc<ChainMatrix>,
    pub gradient: ChainVectors<1>,
}

impl ChainEquations {
    pub fn drive(&self) -> &Drive {
        self.matrix.jacobians.drive()
    }

    /// Gradient of data and priors at a state.
    pub fn gradient_with_priors(
        &self,
        priors: &Priors,
        precisions: &SlowPrecisions,
        state: &StateVector,
    ) -> ChainVectors<1> {
        let mut gradient = self.gradient.clone(); // (20)
        gradient.constants += priors.gradient(&state.constants);
        for (block, slow) in gradient.slow.iter_mut().enumerate() {
            *slow += precisions.multiply(&state.slow, block);
        }
        gradient
    }
}

impl ChainMatrix {
    pub fn new(blocks: Vec<BlockEquations>, jacobians: BlockJacobians) -> Self {
        let constants = ConstantsMatrix::zeros();
        let mut matrix = Self { blocks, jacobians, stored: Vec::new(), constants };
        for chunk in matrix.chunks() {
            let rows: Vec<(ChainRow, ConstantsMatrix)> =
                chunk.clone().into_par_iter().map(|block| matrix.compute_row(block)).collect();
            for (block, (row, constants)) in chunk.zip(rows) {
                matrix.constants += constants;
                if block < MOST_STORED_BLOCKS {
                    matrix.stored.push(row);
                }
            }
        }
        // Rounding must not make it asymmetric.
        matrix.constants = 0.5 * (matrix.constants + matrix.constants.transpose());
        matrix
    }

    /// Number of blocks.
    pub fn len(&self) -> usize {
        self.blocks.len()
    }

    /// Ranges of blocks in their order.
    pub fn chunks(&self) -> impl DoubleEndedIterator<Item = Range<usize>> + use<> {
        let blocks = self.len();
        (0..blocks.div_ceil(CHUNK)).map(move |k| k * CHUNK..blocks.min((k + 1) * CHUNK))
    }

    /// Rows of some blocks.
    pub fn rows(&self, blocks: Range<usize>) -> Cow<'_, [ChainRow]> {
        match self.stored.get(blocks.clone()) {
            Some(stored) => Cow::Borrowed(stored),
            None => blocks.into_par_iter().map(|block| self.compute_row(block).0).collect(),
        }
    }

    /// Row of a block, and its share of the corner.
    fn compute_row(&self, index: usize) -> (ChainRow, ConstantsMatrix) {
        let block = &self.blocks[index];
        // Products with a stored transpose are several times faster than `tr_mul`.
        let (own_by_constants, own_by_slow) = self.jacobians.of_block(index);
        let (by_slow, by_constants) = (own_by_slow.transpose(), own_by_constants.transpose());
        let mut product = block.information * own_by_constants;
        let mut upper = SlowMatrix::zeros();
        if self.jacobians.is_coupled_to_next(index) {
            let (next_by_constants, next_by_slow) = self.jacobians.of_block(index + 1);
            product += block.with_next * next_by_constants;
            upper = by_slow * (block.with_next * next_by_slow);
        }
        let before = index.checked_sub(1);
        if let Some(before) = before.filter(|before| self.jacobians.is_coupled_to_next(*before)) {
            let before_by_constants = self.jacobians.of_block(before).0;
            product += self.blocks[before].with_next.transpose() * before_by_constants;
        }
        let diagonal = by_slow * (block.information * own_by_slow);
        (ChainRow { diagonal, upper, border: by_slow * product }, by_constants * product)
    }

    /// Gradients of the blocks' unknowns at the linearisation point.
    pub fn block_gradients(&self) -> impl Iterator<Item = BlockVector> {
        self.blocks.iter().map(|block| block.gradient)
    }

    /// Gradient of constants and slow states, from that of the blocks' unknowns.
    pub fn gradient(&self, block_gradients: impl Iterator<Item = BlockVector>) -> ChainVectors<1> {
        // (20)
        let mut gradient = ChainVectors::zeros(self.len());
        for (index, block_gradient) in block_gradients.enumerate() {
            let (by_constants, by_slow) = self.jacobians.of_block(index);
            gradient.slow[index] = by_slow.tr_mul(&block_gradient);
            gradient.constants += by_constants.tr_mul(&block_gradient);
        }
        gradient
    }

    /// Rows of `HX` for the slow states of each block.
    pub fn multiply_slow<const K: usize>(&self, x: &ChainVectors<K>) -> Vec<SMatrix<f64, SLOW, K>> {
        let mut product: Vec<SMatrix<f64, SLOW, K>> = Vec::with_capacity(self.len());
        let mut by_before = SMatrix::zeros();
        for chunk in self.chunks() {
            for (block, row) in chunk.clone().zip(self.rows(chunk).iter()) {
                let slow = &x.slow[block];
                let mut own = row.diagonal * slow + row.border * x.constants + by_before;
                if let Some(next) = x.slow.get(block + 1) {
                    own += row.upper * next;
                }
                by_before = row.upper.tr_mul(slow);
                product.push(own);
            }
        }
        product
    }

    /// Returns `XᵀHX`.
    pub fn quadratic_form<const K: usize>(&self, x: &ChainVectors<K>) -> SMatrix<f64, K, K> {
        let constants = &x.constants;
        let mut sum = constants.tr_mul(&(self.constants * constants));
        for chunk in self.chunks() {
            for (block, row) in chunk.clone().zip(self.rows(chunk).iter()) {
                let slow = &x.slow[block];
                let mut across = row.border * constants;
                if let Some(next) = x.slow.get(block + 1) {
                    across += row.upper * next;
                }
                let across = slow.tr_mul(&across);
                sum += slow.tr_mul(&(row.diagonal * slow)) + across + across.transpose();
            }
        }
        sum
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The same matrix without stored rows.
    pub fn without_stored_rows(matrix: &ChainMatrix) -> ChainMatrix {
        ChainMatrix {
            blocks: matrix.blocks.clone(),
            jacobians: matrix.jacobians.clone(),
            stored: Vec::new(),
            constants: matrix.constants,
        }
    }
}
