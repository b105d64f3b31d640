//! Normal equations of the constants and slow states, once the motion is eliminated. They are a chain of blocks, each coupled to the next,
//! with the constants as border.
//!
//! Jacobians of [`super::block_jacobians`] transform the information `H_u` of the blocks' unknowns to θ and s. Diagonal blocks are
//! `J_sᵀ H_u J_s`, the border is `J_sᵀ H_u J_θ`, the corner `Σ J_θᵀ H_u J_θ`. These need twice the memory of the blocks, so those of a long
//! drive are recomputed, some blocks at a time.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::block_jacobians::BlockJacobians;
use super::drive::Drive;
use super::motion_band::BlockEquations;
use super::priors::Priors;
use super::random_walks::{SlowMatrix, SlowPrecisions};
use super::state_vector::{BlockVector, Constants, ConstantsMatrix, Layout, Slow, StateVector};
use crate::linear_algebra::sparse_products::{by_sparse, by_sparse_transpose};

/// Blocks that are computed in parallel.
pub const CHUNK: usize = 256;
/// Blocks whose rows are stored (50 MB; seven hours of a usual drive).
const MOST_STORED_BLOCKS: usize = 16 * CHUNK;

/// A right-hand side or a solution: slow states of each block, and the constants.
#[derive(Clone, Debug)]
pub struct ChainVector {
    pub slow: Vec<Slow>,
    pub constants: Constants,
}

impl ChainVector {
    pub fn zeros(layout: &Layout, blocks: usize) -> Self {
        let slow = vec![Slow::zeros(layout.slow()); blocks];
        Self { slow, constants: Constants::zeros(layout.constants) }
    }

    /// Scalar product.
    pub fn dot(&self, other: &Self) -> f64 {
        let of_blocks = self.slow.iter().zip(&other.slow).map(|(a, b)| a.dot(b));
        self.constants.dot(&other.constants) + of_blocks.sum::<f64>()
    }

    /// Adds a multiple of another vector.
    pub fn add_multiple(&mut self, other: &Self, multiple: f64) {
        self.constants.axpy(multiple, &other.constants, 1.0);
        let slow = self.slow.iter_mut().zip(&other.slow);
        slow.for_each(|(sum, other)| sum.axpy(multiple, other, 1.0));
    }

    /// The same vector times a factor.
    pub fn scaled(&self, factor: f64) -> Self {
        let slow = self.slow.iter().map(|slow| slow * factor).collect();
        Self { slow, constants: &self.constants * factor }
    }
}

/// Block row of the normal matrix, from the data without the priors. Parts beside the diagonal are transposed, so that a row of the factor copies
/// neighbours in memory.
#[derive(Clone, Debug)]
pub struct ChainRow {
    pub diagonal: SlowMatrix,
    /// States of the next block by those of this block.
    pub next: SlowMatrix,
    /// Constants by the states of this block.
    pub border: DMatrix<f64>,
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
    pub gradient: ChainVector,
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
    ) -> ChainVector {
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
        let size = jacobians.drive().layout.constants;
        let mut corner = ConstantsMatrix::zeros(size, size);
        let mut matrix = Self { blocks, jacobians, stored: Vec::new(), constants: corner.clone() };
        for chunk in matrix.chunks() {
            let with_corner = |block: usize| {
                let (row, by_constants) = matrix.compute_row(block);
                let jacobian = matrix.jacobians.of_block(block).0;
                (row, by_sparse_transpose(&jacobian, &by_constants))
            };
            let rows: Vec<_> = chunk.clone().into_par_iter().map(with_corner).collect();
            for (block, (row, share)) in chunk.zip(rows) {
                corner += share;
                if block < MOST_STORED_BLOCKS {
                    matrix.stored.push(row);
                }
            }
        }
        // Rounding must not make it asymmetric.
        matrix.constants = 0.5 * (&corner + corner.transpose());
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

    /// Row of a block, and `H_u J_θ` of the block with its neighbours.
    fn compute_row(&self, index: usize) -> (ChainRow, DMatrix<f64>) {
        let block = &self.blocks[index];
        let (own_by_constants, by_slow) = self.jacobians.of_block(index);
        let mut by_constants = by_sparse(&block.information, &own_by_constants);
        let next = if self.jacobians.is_coupled_to_next(index) {
            let (next_by_constants, next_by_slow) = self.jacobians.of_block(index + 1);
            by_constants += by_sparse(&block.with_next, &next_by_constants);
            by_sparse(&by_sparse(&block.with_next, &next_by_slow).transpose(), &by_slow)
        } else {
            SlowMatrix::zeros(by_slow.ncols(), by_slow.ncols())
        };
        let before = index.checked_sub(1);
        if let Some(before) = before.filter(|before| self.jacobians.is_coupled_to_next(*before)) {
            let before_by_constants = self.jacobians.of_block(before).0;
            let with_before = self.blocks[before].with_next.transpose();
            by_constants += by_sparse(&with_before, &before_by_constants);
        }
        let diagonal = by_sparse_transpose(&by_slow, &by_sparse(&block.information, &by_slow));
        let border = by_sparse(&by_constants.transpose(), &by_slow);
        (ChainRow { diagonal, next, border }, by_constants)
    }

    /// Gradients of the blocks' unknowns at the linearisation point.
    pub fn block_gradients(&self) -> impl Iterator<Item = BlockVector> {
        self.blocks.iter().map(|block| block.gradient.clone())
    }

    /// Gradient of constants and slow states, from that of the blocks' unknowns.
    pub fn gradient(&self, block_gradients: impl Iterator<Item = BlockVector>) -> ChainVector {
        // (20)
        let mut gradient = ChainVector::zeros(&self.jacobians.drive().layout, self.len());
        for (index, block_gradient) in block_gradients.enumerate() {
            let (by_constants, by_slow) = self.jacobians.of_block(index);
            gradient.slow[index] = by_slow.tr_mul(&block_gradient);
            gradient.constants += by_constants.tr_mul(&block_gradient);
        }
        gradient
    }

    /// Returns `Hx` of each of some vectors.
    pub fn multiply(&self, all: &[ChainVector]) -> Vec<ChainVector> {
        let layout = &self.jacobians.drive().layout;
        let mut products = vec![ChainVector::zeros(layout, self.len()); all.len()];
        for (x, product) in all.iter().zip(&mut products) {
            product.constants = &self.constants * &x.constants;
        }
        for chunk in self.chunks() {
            for (block, row) in chunk.clone().zip(self.rows(chunk).iter()) {
                for (x, product) in all.iter().zip(&mut products) {
                    let slow = &x.slow[block];
                    product.constants += &row.border * slow;
                    product.slow[block] += &row.diagonal * slow + row.border.tr_mul(&x.constants);
                    if let Some(next) = x.slow.get(block + 1) {
                        product.slow[block] += row.next.tr_mul(next);
                        product.slow[block + 1] += &row.next * slow;
                    }
                }
            }
        }
        products
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
            constants: matrix.constants.clone(),
        }
    }
}
