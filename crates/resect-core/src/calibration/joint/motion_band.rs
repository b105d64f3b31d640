//! Elimination of the motion: the banded normal matrix of a segment's knots, with a border of the unknowns of its blocks.
//!
//! The columns of a block couple to its own knots, and through the band to later ones, with decreasing size. A moving border as wide
//! as two blocks is enough: the remainder of a block is added to the next but one when that begins. This is exact for
//! changes that all blocks have in common, and nearly so for others. The result is a block tridiagonal matrix over the blocks ([`super::chain`]).

use nalgebra::{SMatrix, SVector};

use super::knot_grid::ORDER;
use super::state_vector::{BLOCK, BlockVector};
use crate::linear_algebra::bordered_band::{
    RIGHT_HAND_SIDE, add_border_gram, back_substitute, factorise, forward_substitute, update,
};

/// Kinds of noise whose redundancy is estimated by random probes.
pub const PROBES: usize = 4;
/// Columns of the border: the gradient, probes, blocks with even indices, and blocks with odd indices.
const FIRST_PROBE: usize = 1;
pub const FIRST_BLOCK: usize = 8;
/// Width of the border, and of one for a step of the motion alone.
pub const BORDER: usize = FIRST_BLOCK + 2 * BLOCK;
pub const MOTION_BORDER: usize = FIRST_BLOCK;
/// Coefficients of a knot and lengths of a row, for a rig of three prisms and for one prism; shorter rows are for steps of the motion
/// alone.
pub const RIG: usize = 9;
pub const RIG_ROW: usize = ORDER * RIG + BORDER;
pub const RIG_MOTION_ROW: usize = ORDER * RIG + MOTION_BORDER;
pub const PRISM: usize = 3;
pub const PRISM_ROW: usize = ORDER * PRISM + BORDER;
pub const PRISM_MOTION_ROW: usize = ORDER * PRISM + MOTION_BORDER;

pub type BlockMatrix = SMatrix<f64, BLOCK, BLOCK>;

/// Rows of a band by knot, as [`bordered_band`](crate::linear_algebra::bordered_band) factorises them.
pub type Rows<const LOCAL: usize, const ROW: usize> = Vec<[[f64; ROW]; LOCAL]>;

/// Normal equations of one segment: `LOCAL` coefficients a knot, `ROW` = 4 × `LOCAL` + [`BORDER`] or + [`MOTION_BORDER`].
pub struct MotionBand<const LOCAL: usize, const ROW: usize> {
    /// The upper triangle, and after elimination its factor.
    rows: Rows<LOCAL, ROW>,
    /// The first knot of each block.
    first_knots: Vec<usize>,
    pub blocks: Vec<BlockEquations>,
    /// Squares of the probes that the motion absorbs.
    pub absorbed: [f64; PROBES],
}

/// Normal equations of a block after the motion is eliminated.
#[derive(Clone, Debug)]
pub struct BlockEquations {
    pub information: BlockMatrix,
    /// Coupling of the block to the next one (rows of this block, columns of the next).
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
    pub const ZERO: Self = Self {
        information: BlockMatrix::from_array_storage(nalgebra::ArrayStorage([[0.0; BLOCK]; BLOCK])),
        with_next: BlockMatrix::from_array_storage(nalgebra::ArrayStorage([[0.0; BLOCK]; BLOCK])),
        gradient: BlockVector::from_array_storage(nalgebra::ArrayStorage([[0.0; BLOCK]; 1])),
    };
}

impl<const LOCAL: usize, const ROW: usize> MotionBand<LOCAL, ROW> {
    const WIDTH: usize = ROW - ORDER * LOCAL;
    /// False for a step of the motion alone.
    pub const HAS_BLOCKS: bool = Self::WIDTH > MOTION_BORDER;

    /// Returns a band without equations that reuses the memory of `rows`; blocks begin at `first_knots`, the first at 0.
    pub fn new(mut rows: Rows<LOCAL, ROW>, knots: usize, first_knots: Vec<usize>) -> Self {
        rows.clear();
        rows.resize(knots, [[0.0; ROW]; LOCAL]);
        let blocks = vec![BlockEquations::ZERO; first_knots.len()];
        Self { rows, first_knots, blocks, absorbed: [0.0; PROBES] }
    }

    pub fn into_rows(self) -> Rows<LOCAL, ROW> {
        self.rows
    }

    /// Takes the rows out, to reuse their memory; the normal equations of the blocks stay.
    pub fn take_rows(&mut self) -> Rows<LOCAL, ROW> {
        std::mem::take(&mut self.rows)
    }

    /// Rows by knot: after elimination the Cholesky factor, and the coupling of each knot to the next knots and the border.
    pub fn rows(&self) -> &Rows<LOCAL, ROW> {
        &self.rows
    }

    pub fn has_rows(&self) -> bool {
        !self.rows.is_empty()
    }

    /// Adds equations of `SIZE` unknowns of each of four knots, from coefficient `offset` on: information matrix and gradient.
    pub fn add<const SIZE: usize>(
        &mut self,
        KnotFactors { first, factors }: KnotFactors<'_>,
        offset: usize,
        information: &SMatrix<f64, SIZE, SIZE>,
        gradient: &SVector<f64, SIZE>,
    ) {
        for k in 0..ORDER {
            for i in 0..SIZE {
                let row = &mut self.rows[first + k][offset + i];
                for l in k..ORDER {
                    let both = factors[k] * factors[l];
                    let block = &mut row[LOCAL * (l - k) + offset..][..SIZE];
                    for j in 0..SIZE {
                        block[j] += both * information[(i, j)];
                    }
                }
                row[ORDER * LOCAL + RIGHT_HAND_SIDE] += factors[k] * gradient[i];
            }
        }
    }

    /// Adds one equation for each unknown of four knots, all of the same precision, and their gradients.
    pub fn add_each(
        &mut self,
        KnotFactors { first, factors }: KnotFactors<'_>,
        precision: f64,
        gradient: &[f64; LOCAL],
    ) {
        for k in 0..ORDER {
            for l in k..ORDER {
                let both = precision * factors[k] * factors[l];
                for (i, row) in self.rows[first + k].iter_mut().enumerate() {
                    row[LOCAL * (l - k) + i] += both;
                }
            }
            for (row, value) in self.rows[first + k].iter_mut().zip(gradient) {
                row[ORDER * LOCAL + RIGHT_HAND_SIDE] += factors[k] * value;
            }
        }
    }

    /// Adds the coupling of `SIZE` unknowns of each of four knots to an unknown of a block.
    pub fn add_border<const SIZE: usize>(
        &mut self,
        knots: KnotFactors<'_>,
        offset: usize,
        BlockUnknown { block, column }: BlockUnknown,
        values: &SVector<f64, SIZE>,
    ) {
        self.add_column(knots, offset, FIRST_BLOCK + BLOCK * (block % 2) + column, values);
    }

    /// Adds to a probe.
    pub fn add_probe<const SIZE: usize>(
        &mut self,
        knots: KnotFactors<'_>,
        offset: usize,
        probe: usize,
        values: &SVector<f64, SIZE>,
    ) {
        self.add_column(knots, offset, FIRST_PROBE + probe, values);
    }

    /// Adds to a column of the border.
    fn add_column<const SIZE: usize>(
        &mut self,
        KnotFactors { first, factors }: KnotFactors<'_>,
        offset: usize,
        column: usize,
        values: &SVector<f64, SIZE>,
    ) {
        for k in 0..ORDER {
            for i in 0..SIZE {
                self.rows[first + k][offset + i][ORDER * LOCAL + column] += factors[k] * values[i];
            }
        }
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
        let knots = self.rows.len();
        let mut gram = [[0.0; BORDER]; BORDER];
        for knot in 0..knots {
            let blocks = self.border_blocks(knot);
            let last = blocks.into_iter().flatten().max().unwrap_or(0);
            let next_begins = self.first_knots.get(last + 1).copied().unwrap_or(usize::MAX);
            let (own, after) = self.rows[knot..].split_first_mut().expect("a knot");
            if !factorise(own) {
                return false;
            }
            if let Some(target) = after.first_mut() {
                update::<LOCAL, ROW, 1>(own, target);
            }
            if let Some(target) = after.get_mut(1) {
                update::<LOCAL, ROW, 2>(own, target);
            }
            if let Some(target) = after.get_mut(2) {
                update::<LOCAL, ROW, 3>(own, target);
            }
            add_border_gram(&mut gram, own);
            if !Self::HAS_BLOCKS {
                continue;
            }
            let ends =
                |block: usize| knot + 1 == knots || (block < last && next_begins == knot + 1);
            for block in last.saturating_sub(1)..=last {
                if ends(block) {
                    self.move_to_blocks(block, &mut gram);
                }
            }
        }
        for (probe, sum) in self.absorbed.iter_mut().enumerate() {
            *sum = gram[FIRST_PROBE + probe][FIRST_PROBE + probe];
        }
        true
    }

    /// Moves the Schur complement of a block from the border to [`MotionBand::blocks`]; the next block has the other half.
    fn move_to_blocks(&mut self, block: usize, gram: &mut [[f64; BORDER]; BORDER]) {
        let own = FIRST_BLOCK + BLOCK * (block % 2);
        let other = FIRST_BLOCK + BLOCK * ((block + 1) % 2);
        let sum = |gram: &[[f64; BORDER]; BORDER], i: usize, j: usize| gram[i.min(j)][i.max(j)];
        for i in 0..BLOCK {
            for j in 0..BLOCK {
                self.blocks[block].information[(i, j)] -= sum(gram, own + i, own + j);
                if block + 1 < self.blocks.len() {
                    self.blocks[block].with_next[(i, j)] -= sum(gram, own + i, other + j);
                }
            }
            self.blocks[block].gradient[i] -= sum(gram, own + i, RIGHT_HAND_SIDE);
        }
        for i in own..own + BLOCK {
            for j in 0..BORDER {
                gram[i.min(j)][i.max(j)] = 0.0;
            }
        }
    }

    /// Replaces the gradient of an eliminated band, and returns the gradients of the blocks after elimination.
    pub fn replace_gradient(
        &mut self,
        mut local: Vec<[f64; LOCAL]>,
        mut block_gradients: Vec<BlockVector>,
    ) -> Vec<BlockVector> {
        for knot in 0..self.rows.len() {
            let blocks = self.border_blocks(knot);
            let mut border = [0.0; BORDER];
            let (own, after) = local[knot..].split_first_mut().expect("a knot");
            forward_substitute(&mut self.rows[knot], own, after, &mut border);
            for block in blocks.into_iter().flatten() {
                let own = FIRST_BLOCK + BLOCK * (block % 2);
                let absorbed = BlockVector::from_column_slice(&border[own..own + BLOCK]);
                block_gradients[block] -= absorbed;
            }
        }
        block_gradients
    }

    /// Returns the step of the coefficients for given steps of the blocks; all are to be subtracted.
    pub fn motion_step(&self, block_steps: &[BlockVector]) -> Vec<f64> {
        let mut step = vec![0.0; self.rows.len() * LOCAL];
        for knot in (0..self.rows.len()).rev() {
            let mut border = [0.0; BORDER];
            border[RIGHT_HAND_SIDE] = -1.0;
            for block in self.border_blocks(knot).into_iter().flatten().filter(|_| Self::HAS_BLOCKS)
            {
                let own = FIRST_BLOCK + BLOCK * (block % 2);
                border[own..own + BLOCK].copy_from_slice(block_steps[block].as_slice());
            }
            let beyond = step.len().min((knot + ORDER) * LOCAL);
            back_substitute(&self.rows[knot], &border, &mut step[knot * LOCAL..beyond]);
        }
        step
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use rand::{RngExt, SeedableRng};

    pub const LOCAL: usize = 3;
    pub const ROW: usize = ORDER * LOCAL + BORDER;
    pub const KNOTS: usize = 40;

    /// A band of random equations in three blocks, and the same equations as a dense normal matrix and gradient, in which the
    /// three blocks are one.
    pub fn example() -> (MotionBand<LOCAL, ROW>, DMatrix<f64>, DVector<f64>) {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let first_knots = vec![0, 13, 26];
        let mut band = MotionBand::<LOCAL, ROW>::new(Vec::new(), KNOTS, first_knots);
        let size = KNOTS * LOCAL + BLOCK;
        let (mut full, mut gradient) = (DMatrix::zeros(size, size), DVector::zeros(size));
        for first in 0..KNOTS - (ORDER - 1) {
            let block = [0, 13, 26].iter().filter(|begin| **begin <= first).count() - 1;
            for _ in 0..3 {
                let factors: [f64; ORDER] = std::array::from_fn(|_| rng.random_range(0.0..1.0));
                let direction = SVector::<f64, LOCAL>::from_fn(|_, _| rng.random_range(-1.0..1.0));
                let columns = BlockVector::from_fn(|_, _| rng.random_range(-1.0..1.0));
                let error: f64 = rng.random_range(-1.0..1.0);
                let information = direction * direction.transpose();
                let knots = KnotFactors { first, factors: &factors };
                band.add(knots, 0, &information, &(direction * error));
                for column in 0..BLOCK {
                    let values = direction * columns[column];
                    band.add_border(knots, 0, BlockUnknown { block, column }, &values);
                }
                band.blocks[block].information += columns * columns.transpose();
                band.blocks[block].gradient += columns * error;
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
            let information = SMatrix::<f64, LOCAL, LOCAL>::identity();
            band.add(knots, 0, &information, &SVector::zeros());
            (0..LOCAL).for_each(|i| full[(knot * LOCAL + i, knot * LOCAL + i)] += 0.09);
        }
        for knot in KNOTS - (ORDER - 1)..KNOTS {
            let factors = &[0.0, 0.0, 0.0, 0.3];
            let information = SMatrix::<f64, LOCAL, LOCAL>::identity();
            let knots = KnotFactors { first: knot - (ORDER - 1), factors };
            band.add(knots, 0, &information, &SVector::zeros());
            (0..LOCAL).for_each(|i| full[(knot * LOCAL + i, knot * LOCAL + i)] += 0.09);
        }
        (band, full, gradient)
    }

    #[test]
    fn the_sum_of_all_blocks_is_the_dense_solution() {
        let (mut band, full, gradient) = example();
        assert!(band.eliminate());
        let (mut information, mut pull) = (BlockMatrix::zeros(), BlockVector::zeros());
        for block in &band.blocks {
            information += block.information + block.with_next + block.with_next.transpose();
            pull += block.gradient;
        }
        let locals = KNOTS * LOCAL;
        let dense = full.clone().cholesky().expect("definite").solve(&gradient);
        let inverse = full.try_inverse().expect("definite");
        let expected = inverse.view((locals, locals), (BLOCK, BLOCK)).into_owned();
        let expected = expected.try_inverse().expect("definite");
        assert!(
            (information - &expected).amax() < 1e-9 * expected.amax(),
            "{information} {expected}"
        );
        let step = information.cholesky().expect("definite").solve(&pull);
        assert!((step - dense.rows(locals, BLOCK)).amax() < 1e-8, "{step}");
        let local = band.motion_step(&[step; 3]);
        for (found, expected) in local.iter().zip(dense.iter()) {
            assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        }
    }
}
