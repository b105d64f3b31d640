//! Elimination of the motion: the banded normal matrix of a segment's knots, with a border of the unknowns of its blocks.
//!
//! The columns of a block couple to its own knots, and through the band to later ones, with decreasing size. A moving border as wide
//! as two blocks is enough: the remainder of a block is added to the next but one when that begins. This is exact for
//! changes that all blocks have in common, and nearly so for others. The result is a block tridiagonal matrix over the blocks ([`super::chain`]).

use nalgebra::{DMatrix, Matrix3, Vector3};

use super::knot_grid::ORDER;
use super::state_vector::BlockVector;
use crate::linear_algebra::bordered_rows::{
    RowShape, add_border_gram, back_substitute, factorise, forward_substitute, update,
};

/// Kinds of noise whose redundancy is estimated by random probes.
pub const PROBES: usize = 6;
/// Columns of the border: the gradient, blocks with even indices, blocks with odd indices, and probes.
const GRADIENT: usize = 0;
pub const FIRST_BLOCK: usize = 1;

pub type BlockMatrix = DMatrix<f64>;

/// Rows of a band by knot, as [`bordered_rows`](crate::linear_algebra::bordered_rows) factorises them.
pub type Rows = Vec<f64>;

/// Shape of a block row: a knot with some coefficients, and a border for blocks with so many unknowns and for so many probes.
pub fn band_shape(local: usize, block: usize, probes: usize) -> RowShape {
    let border = FIRST_BLOCK + 2 * block + probes;
    RowShape { size: local, blocks: ORDER, border: border.next_multiple_of(4) }
}

/// Normal equations of one segment.
pub struct MotionBand {
    /// The upper triangle, and after elimination its factor.
    rows: Rows,
    shape: RowShape,
    /// Number of unknowns of a block; zero for a step of the motion alone.
    block: usize,
    /// The first knot of each block.
    first_knots: Vec<usize>,
    pub blocks: Vec<BlockEquations>,
    /// Squares of the probes that the motion absorbs; zeros without probes.
    pub absorbed: [f64; PROBES],
}

/// Normal equations of a block after the motion is eliminated.
#[derive(Clone, Debug)]
pub struct BlockEquations {
    pub information: BlockMatrix,
    /// Coupling of the block to the next one of the segment (rows of this block, columns of the next); empty for the last one.
    pub with_next: BlockMatrix,
    pub gradient: BlockVector,
}

/// Four consecutive knots, and the factor of each in an equation.
#[derive(Clone, Copy)]
pub struct KnotFactors<'a> {
    pub first: usize,
    pub factors: &'a [f64; ORDER],
}

/// An unknown of a block.
#[derive(Clone, Copy)]
pub struct BlockUnknown {
    pub block: usize,
    /// Index among the unknowns of the block.
    pub column: usize,
}

impl BlockEquations {
    fn zeros(size: usize) -> Self {
        Self {
            information: BlockMatrix::zeros(size, size),
            with_next: BlockMatrix::zeros(size, size),
            gradient: BlockVector::zeros(size),
        }
    }
}

impl MotionBand {
    /// Returns a band without equations that reuses the memory of `rows`; blocks begin at `first_knots`, the first at 0.
    pub fn new(
        mut rows: Rows,
        shape: RowShape,
        block: usize,
        knots: usize,
        first_knots: Vec<usize>,
    ) -> Self {
        rows.clear();
        rows.resize(knots * shape.numbers(), 0.0);
        let mut blocks = vec![BlockEquations::zeros(block); first_knots.len()];
        if let Some(last) = blocks.last_mut() {
            last.with_next = BlockMatrix::zeros(0, 0);
        }
        Self { rows, shape, block, first_knots, blocks, absorbed: [0.0; PROBES] }
    }

    /// Returns false for a step of the motion alone.
    pub fn has_blocks(&self) -> bool {
        self.block > 0
    }

    pub fn into_rows(self) -> Rows {
        self.rows
    }

    /// Takes the rows out, to reuse their memory; the normal equations of the blocks stay.
    pub fn take_rows(&mut self) -> Rows {
        std::mem::take(&mut self.rows)
    }

    /// Rows by knot: after elimination the Cholesky factor, and the coupling of each knot to the next knots and the border.
    pub fn knots(&self) -> impl ExactSizeIterator<Item = &[f64]> + DoubleEndedIterator {
        self.rows.chunks_exact(self.shape.numbers())
    }

    pub fn shape(&self) -> RowShape {
        self.shape
    }

    /// Number of unknowns of a block; zero for a step of the motion alone.
    pub fn block(&self) -> usize {
        self.block
    }

    pub fn has_rows(&self) -> bool {
        !self.rows.is_empty()
    }

    /// The numbers of a coefficient of a knot.
    fn row(&mut self, knot: usize, coefficient: usize) -> &mut [f64] {
        let width = self.shape.width();
        &mut self.rows[width * (self.shape.size * knot + coefficient)..][..width]
    }

    /// Adds equations of the coordinates of one prism, from coefficient `first` of each of four knots on: information matrix and gradient.
    pub fn add_prism(
        &mut self,
        knots: KnotFactors<'_>,
        first: usize,
        information: &Matrix3<f64>,
        gradient: &Vector3<f64>,
    ) {
        let information: [[f64; 3]; 3] = information.transpose().into();
        self.add(knots, first, information.as_flattened(), gradient.as_ref());
    }

    /// Adds equations of all coefficients of each of four knots: information matrix by rows, and gradient.
    pub fn add_knot(&mut self, knots: KnotFactors<'_>, information: &[f64], gradient: &[f64]) {
        self.add(knots, 0, information, gradient);
    }

    #[inline(always)]
    fn add(
        &mut self,
        KnotFactors { first: first_knot, factors }: KnotFactors<'_>,
        first: usize,
        information: &[f64],
        gradient: &[f64],
    ) {
        let RowShape { size: local, .. } = self.shape;
        let right = self.shape.first_of_border() + GRADIENT;
        let size = gradient.len();
        for k in 0..ORDER {
            for i in 0..size {
                let of_row = &information[size * i..][..size];
                let row = self.row(first_knot + k, first + i);
                for l in k..ORDER {
                    let both = factors[k] * factors[l];
                    let block = &mut row[local * (l - k) + first..][..size];
                    for (sum, value) in block.iter_mut().zip(of_row) {
                        *sum += both * value;
                    }
                }
                row[right] += factors[k] * gradient[i];
            }
        }
    }

    /// Adds one equation for each unknown of four knots, with these precisions, and their gradients.
    pub fn add_each(
        &mut self,
        KnotFactors { first, factors }: KnotFactors<'_>,
        precisions: &[f64],
        gradient: &[f64],
    ) {
        let local = self.shape.size;
        let right = self.shape.first_of_border() + GRADIENT;
        for k in 0..ORDER {
            for (i, (value, precision)) in gradient.iter().zip(precisions).enumerate() {
                let row = self.row(first + k, i);
                for l in k..ORDER {
                    row[local * (l - k) + i] += precision * factors[k] * factors[l];
                }
                row[right] += factors[k] * value;
            }
        }
    }

    /// Adds the coupling of some unknowns of each of four knots, from coefficient `first` on, to an unknown of a block.
    pub fn add_border(
        &mut self,
        knots: KnotFactors<'_>,
        first: usize,
        BlockUnknown { block, column }: BlockUnknown,
        values: &[f64],
    ) {
        self.add_column(knots, first, self.first_column(block) + column, values);
    }

    /// Adds to a probe.
    pub fn add_probe(
        &mut self,
        knots: KnotFactors<'_>,
        first: usize,
        probe: usize,
        values: &[f64],
    ) {
        self.add_column(knots, first, self.first_probe() + probe, values);
    }

    /// Adds to a column of the border.
    fn add_column(
        &mut self,
        KnotFactors { first: first_knot, factors }: KnotFactors<'_>,
        first: usize,
        column: usize,
        values: &[f64],
    ) {
        let column = self.shape.first_of_border() + column;
        for (k, factor) in factors.iter().enumerate() {
            for (i, value) in values.iter().enumerate() {
                self.row(first_knot + k, first + i)[column] += factor * value;
            }
        }
    }

    /// First column of the probes in the border; its width without any.
    fn first_probe(&self) -> usize {
        FIRST_BLOCK + 2 * self.block
    }

    /// First column of a block in the border.
    fn first_column(&self, block: usize) -> usize {
        FIRST_BLOCK + self.block * (block % 2)
    }

    /// Returns the blocks in the two halves of the border at a knot: the last even and the last odd one that has begun.
    fn border_blocks(&self, knot: usize) -> [Option<usize>; 2] {
        let begun = self.first_knots.partition_point(|first| *first <= knot);
        let last = begun - 1;
        let mut blocks = [None; 2];
        blocks[last % 2] = Some(last);
        blocks[(last + 1) % 2] = last.checked_sub(1);
        blocks
    }

    /// Eliminates the motion; `false` if its normal matrix is not positive definite.
    pub fn eliminate(&mut self) -> bool {
        let shape = self.shape;
        let knots = self.rows.len() / shape.numbers();
        let mut rows = self.take_rows();
        let mut gram = vec![0.0; shape.border * shape.border];
        let mut is_definite = true;
        for knot in 0..knots {
            let (own, after) = rows[knot * shape.numbers()..].split_at_mut(shape.numbers());
            is_definite = factorise(own, shape);
            if !is_definite {
                break;
            }
            for (away, target) in (1..ORDER).zip(after.chunks_exact_mut(shape.numbers())) {
                update(own, target, shape, away);
            }
            add_border_gram(&mut gram, own, shape);
            if self.has_blocks() {
                self.move_ended_blocks(knot, knots, &mut gram);
            }
        }
        let diagonal = gram.iter().step_by(shape.border + 1).skip(self.first_probe());
        for (sum, absorbed) in self.absorbed.iter_mut().zip(diagonal) {
            *sum = *absorbed;
        }
        self.rows = rows;
        is_definite
    }

    /// Moves the blocks that end at a knot from the border to [`MotionBand::blocks`].
    fn move_ended_blocks(&mut self, knot: usize, knots: usize, gram: &mut [f64]) {
        let last = self.border_blocks(knot).into_iter().flatten().max().unwrap_or(0);
        let next_begins = self.first_knots.get(last + 1).copied().unwrap_or(usize::MAX);
        for block in last.saturating_sub(1)..=last {
            if knot + 1 == knots || (block < last && next_begins == knot + 1) {
                self.move_to_blocks(block, gram);
            }
        }
    }

    /// Moves the Schur complement of a block from the border to [`MotionBand::blocks`]; the next block has the other half.
    fn move_to_blocks(&mut self, block: usize, gram: &mut [f64]) {
        let border = self.shape.border;
        let (own, other) = (self.first_column(block), self.first_column(block + 1));
        let sum = |gram: &[f64], i: usize, j: usize| gram[border * i.min(j) + i.max(j)];
        for i in 0..self.block {
            for j in 0..self.block {
                self.blocks[block].information[(i, j)] -= sum(gram, own + i, own + j);
                if block + 1 < self.blocks.len() {
                    self.blocks[block].with_next[(i, j)] -= sum(gram, own + i, other + j);
                }
            }
            self.blocks[block].gradient[i] -= sum(gram, own + i, GRADIENT);
        }
        for i in own..own + self.block {
            for j in 0..border {
                gram[border * i.min(j) + i.max(j)] = 0.0;
            }
        }
    }

    /// Replaces the gradient of an eliminated band, and returns the gradients of the blocks after elimination.
    pub fn replace_gradient(
        &mut self,
        mut local: Vec<f64>,
        mut block_gradients: Vec<BlockVector>,
    ) -> Vec<BlockVector> {
        self.eliminate_from([(&mut local[..], &mut block_gradients[..])].as_mut_slice());
        let (first, width) = (self.shape.first_of_border(), self.shape.width());
        for (row, value) in self.rows.chunks_exact_mut(width).zip(local) {
            row[first + GRADIENT] = value;
        }
        block_gradients
    }

    /// Eliminates the motion from some gradients by coefficient, which changes those by the unknowns of the blocks. Each row is read once for all.
    pub fn eliminate_from(&self, gradients: &mut [(&mut [f64], &mut [BlockVector])]) {
        let (shape, size) = (self.shape, self.shape.size);
        let mut border = vec![0.0; shape.border];
        for (knot, rows) in self.knots().enumerate() {
            let blocks = self.border_blocks(knot);
            for (local, of_blocks) in gradients.iter_mut() {
                border.fill(0.0);
                let beyond = local.len().min((knot + ORDER) * size);
                let (own, after) = local[knot * size..beyond].split_at_mut(size);
                forward_substitute(rows, shape, own, after, &mut border);
                for block in blocks.into_iter().flatten() {
                    let absorbed = &border[self.first_column(block)..][..self.block];
                    for (sum, absorbed) in of_blocks[block].iter_mut().zip(absorbed) {
                        *sum += absorbed;
                    }
                }
            }
        }
    }

    /// Replaces each gradient by the change of the coefficients that it causes, while the unknowns of the blocks are constant.
    pub fn solve_motion(&self, gradients: &mut [Vec<f64>]) {
        let (shape, size) = (self.shape, self.shape.size);
        let of_blocks = vec![BlockVector::zeros(self.block); self.first_knots.len()];
        let mut of_blocks = vec![of_blocks; gradients.len()];
        let with_blocks = gradients.iter_mut().zip(&mut of_blocks);
        let mut with_blocks: Vec<(&mut [f64], &mut [BlockVector])> =
            with_blocks.map(|(knots, blocks)| (&mut knots[..], &mut blocks[..])).collect();
        self.eliminate_from(&mut with_blocks);
        let border = vec![0.0; shape.border];
        for (knot, rows) in self.knots().enumerate().rev() {
            for changes in gradients.iter_mut() {
                let beyond = changes.len().min((knot + ORDER) * size);
                back_substitute(rows, shape, &mut changes[knot * size..beyond], &border);
            }
        }
    }

    /// Returns the step of the coefficients for given steps of the blocks; all are to be subtracted.
    pub fn motion_step(&self, block_steps: &[BlockVector]) -> Vec<f64> {
        let (shape, size) = (self.shape, self.shape.size);
        let knots = self.rows.len() / shape.numbers();
        let mut step = vec![0.0; knots * size];
        let mut border = vec![0.0; shape.border];
        for (knot, rows) in self.knots().enumerate().rev() {
            border.fill(0.0);
            border[GRADIENT] = -1.0;
            for block in
                self.border_blocks(knot).into_iter().flatten().filter(|_| self.has_blocks())
            {
                border[self.first_column(block)..][..self.block]
                    .copy_from_slice(block_steps[block].as_slice());
            }
            let beyond = step.len().min((knot + ORDER) * size);
            back_substitute(rows, shape, &mut step[knot * size..beyond], &border);
        }
        step
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use nalgebra::DVector;
    use rand::{RngExt, SeedableRng};

    pub const LOCAL: usize = 3;
    pub const BLOCK: usize = 14;
    pub const KNOTS: usize = 40;

    /// A band of random equations in three blocks, and the same equations as a dense normal matrix and gradient, in which the
    /// three blocks are one.
    pub fn example() -> (MotionBand, DMatrix<f64>, DVector<f64>) {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let first_knots = vec![0, 13, 26];
        let shape = band_shape(LOCAL, BLOCK, 0);
        let mut band = MotionBand::new(Vec::new(), shape, BLOCK, KNOTS, first_knots);
        let size = KNOTS * LOCAL + BLOCK;
        let (mut full, mut gradient) = (DMatrix::zeros(size, size), DVector::zeros(size));
        for first in 0..KNOTS - (ORDER - 1) {
            let block = [0, 13, 26].iter().filter(|begin| **begin <= first).count() - 1;
            for _ in 0..3 {
                let factors: [f64; ORDER] = std::array::from_fn(|_| rng.random_range(0.0..1.0));
                let direction = Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0));
                let columns = BlockVector::from_fn(BLOCK, |_, _| rng.random_range(-1.0..1.0));
                let error: f64 = rng.random_range(-1.0..1.0);
                let information = direction * direction.transpose();
                let knots = KnotFactors { first, factors: &factors };
                band.add_prism(knots, 0, &information, &(direction * error));
                for column in 0..BLOCK {
                    let values = direction * columns[column];
                    let unknown = BlockUnknown { block, column };
                    band.add_border(knots, 0, unknown, values.as_slice());
                }
                band.blocks[block].information += &columns * columns.transpose();
                band.blocks[block].gradient += &columns * error;
                let mut row = DVector::zeros(size);
                for k in 0..ORDER {
                    for i in 0..LOCAL {
                        row[(first + k) * LOCAL + i] = factors[k] * direction[i];
                    }
                }
                row.rows_mut(KNOTS * LOCAL, BLOCK).copy_from(&columns);
                full.ger(1.0, &row, &row, 1.0);
                gradient.axpy(error, &row, 1.0);
            }
        }
        for knot in 0..KNOTS - (ORDER - 1) {
            let knots = KnotFactors { first: knot, factors: &[0.3, 0.0, 0.0, 0.0] };
            band.add_prism(knots, 0, &Matrix3::identity(), &Vector3::zeros());
            (0..LOCAL).for_each(|i| full[(knot * LOCAL + i, knot * LOCAL + i)] += 0.09);
        }
        for knot in KNOTS - (ORDER - 1)..KNOTS {
            let factors = &[0.0, 0.0, 0.0, 0.3];
            let knots = KnotFactors { first: knot - (ORDER - 1), factors };
            band.add_prism(knots, 0, &Matrix3::identity(), &Vector3::zeros());
            (0..LOCAL).for_each(|i| full[(knot * LOCAL + i, knot * LOCAL + i)] += 0.09);
        }
        (band, full, gradient)
    }

    #[test]
    fn the_sum_of_all_blocks_is_the_dense_solution() {
        let (mut band, full, gradient) = example();
        assert!(band.eliminate());
        let mut information = BlockMatrix::zeros(BLOCK, BLOCK);
        let mut pull = BlockVector::zeros(BLOCK);
        for block in &band.blocks {
            information += &block.information;
            if !block.with_next.is_empty() {
                information += &block.with_next + block.with_next.transpose();
            }
            pull += &block.gradient;
        }
        let locals = KNOTS * LOCAL;
        let dense = full.clone().cholesky().expect("definite").solve(&gradient);
        let inverse = full.try_inverse().expect("definite");
        let expected = inverse.view((locals, locals), (BLOCK, BLOCK)).into_owned();
        let expected = expected.try_inverse().expect("definite");
        assert!(
            (&information - &expected).amax() < 1e-9 * expected.amax(),
            "{information} {expected}"
        );
        let step = information.cholesky().expect("definite").solve(&pull);
        assert!((&step - dense.rows(locals, BLOCK)).amax() < 1e-8, "{step}");
        let local = band.motion_step(&[step.clone(), step.clone(), step]);
        for (found, expected) in local.iter().zip(dense.iter()) {
            assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        }
    }
}
