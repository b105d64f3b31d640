//! Cholesky factor of the chain's normal matrix with the priors, its solutions, and the covariance of constants and slow states.
//!
//! The slow states are eliminated block by block, as in a Kalman smoother (Rauch, Tung & Striebel 1965), which leaves the
//! constants. The rows of a long drive's factor are not stored but recomputed, some blocks at a time.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::{Cholesky, DMatrix, Dyn};

use super::chain::{CHUNK, ChainMatrix, ChainRow, ChainVector};
use super::random_walks::{SlowMatrix, SlowPrecisions, WalkMatrix};
use super::state_vector::{Constants, ConstantsMatrix, Layout};
use crate::linear_algebra::bordered_rows::{
    RowShape, add_border_gram, back_substitute, factorise, forward_substitute, update,
};

/// Blocks whose rows of the factor are stored (6 MB; an hour of a usual drive). Several factors are in memory at once.
const MOST_STORED_ROWS: usize = 2 * CHUNK;

/// Block row of the factor.
pub type FactorRow = Vec<f64>;
type ConstantsFactor = Cholesky<f64, Dyn>;

/// Shape of a block row: the slow states of a block, coupled to those of the next one, with the constants as border.
pub fn chain_shape(layout: &Layout) -> RowShape {
    RowShape { size: layout.slow(), blocks: 2, border: layout.constants.next_multiple_of(4) }
}

/// Factorised normal matrix of data and priors.
pub struct ChainFactor {
    matrix: Arc<ChainMatrix>,
    pub priors: SlowPrecisions,
    shape: RowShape,
    /// Rows of the first blocks.
    stored: Vec<FactorRow>,
    /// The row before each chunk of blocks, from which rows that are not stored are recomputed.
    before_chunks: Vec<Option<FactorRow>>,
    constants: ConstantsFactor,
}

/// Covariance of the slow states of a block.
pub struct SlowCovariance {
    pub own: SlowMatrix,
    /// Covariance with the constants, as slow states by constants.
    pub with_constants: DMatrix<f64>,
    /// Covariance with the states of the next block; `None` for the last.
    pub with_next: Option<SlowMatrix>,
}

impl ChainFactor {
    /// Factorises, and solves for a right-hand side; `None` if the matrix is not positive definite.
    pub fn new(
        matrix: &Arc<ChainMatrix>,
        information: &ConstantsMatrix,
        priors: &SlowPrecisions,
        right: &ChainVector,
    ) -> Option<(Self, ChainVector)> {
        let shape = chain_shape(&matrix.jacobians.drive().layout);
        let mut stored = Vec::with_capacity(matrix.len().min(MOST_STORED_ROWS));
        let mut before_chunks = Vec::new();
        let mut elimination = ChainElimination::new(shape, priors);
        let mut right = RightHandSide::new(right, shape);
        for chunk in matrix.chunks() {
            before_chunks.push(elimination.before.clone());
            for (block, row) in chunk.clone().zip(matrix.rows(chunk).iter()) {
                let rows = elimination.eliminate(row, block)?;
                right.forward(block, rows);
                if block < MOST_STORED_ROWS {
                    stored.push(rows.clone());
                }
            }
        }
        let (constants, _) = elimination.constants(&matrix.constants, information)?;
        let (matrix, priors) = (Arc::clone(matrix), priors.clone());
        let factor = Self { matrix, priors, shape, stored, before_chunks, constants };
        let solution = factor.backward(vec![right]).pop()?;
        Some((factor, solution))
    }

    /// Frees memory; rows that are needed again are recomputed.
    pub fn forget_rows(&mut self) {
        self.stored = Vec::new();
    }

    /// Returns the solution of the constants, once all blocks are eliminated from their right-hand side.
    pub fn solve_constants(&self, right: &[f64]) -> Constants {
        self.constants.solve(&Constants::from_column_slice(right))
    }

    /// Returns the rows of one chunk of [`ChainMatrix::chunks`].
    pub fn rows(&self, blocks: Range<usize>) -> Cow<'_, [FactorRow]> {
        if let Some(stored) = self.stored.get(blocks.clone()) {
            return Cow::Borrowed(stored);
        }
        let mut before = self.before_chunks[blocks.start / CHUNK].clone();
        let rows = self.matrix.rows(blocks.clone());
        // The same rows were positive definite before.
        let factorised = |(block, row)| {
            let mut own = FactorRow::new();
            factor_row(row, (&self.priors, self.shape), block, before.as_ref(), &mut own)?;
            before = Some(own);
            before.clone()
        };
        blocks.zip(rows.iter()).map_while(factorised).collect()
    }

    /// Covariance of the constants.
    pub fn constants_covariance(&self) -> ConstantsMatrix {
        self.constants.inverse()
    }

    /// Returns the solutions for some right-hand sides.
    pub fn solve(&self, right: &[ChainVector]) -> Vec<ChainVector> {
        let mut right: Vec<RightHandSide> =
            right.iter().map(|right| RightHandSide::new(right, self.shape)).collect();
        for chunk in self.matrix.chunks() {
            let rows = self.rows(chunk.clone());
            for (block, rows) in chunk.zip(rows.iter()) {
                right.iter_mut().for_each(|right| right.forward(block, rows));
            }
        }
        self.backward(right)
    }

    /// Returns the solution for one right-hand side.
    pub fn solve_one(&self, right: &ChainVector) -> ChainVector {
        self.solve(std::slice::from_ref(right)).swap_remove(0)
    }

    /// Back substitution.
    fn backward(&self, mut right: Vec<RightHandSide>) -> Vec<ChainVector> {
        let layout = &self.matrix.jacobians.drive().layout;
        for right in &mut right {
            let mut constants = Constants::from_column_slice(&right.constants[..layout.constants]);
            self.constants.solve_mut(&mut constants);
            right.constants[..layout.constants].copy_from_slice(constants.as_slice());
        }
        for chunk in self.matrix.chunks().rev() {
            for (block, rows) in chunk.clone().zip(self.rows(chunk).iter()).rev() {
                right.iter_mut().for_each(|right| right.back(block, rows));
            }
        }
        right.into_iter().map(|right| right.into_vector(layout)).collect()
    }

    /// Covariance of the increment of the random walks from each block to the next.
    pub fn increment_covariances(&self) -> Vec<WalkMatrix> {
        let walks = self.matrix.jacobians.drive().layout.slow_ranges();
        let walking = |block: &SlowMatrix| block.view((0, 0), (walks, walks)).into_owned();
        let mut increments =
            vec![WalkMatrix::zeros(walks, walks); self.matrix.len().saturating_sub(1)];
        let mut after: Option<SlowMatrix> = None;
        self.each_covariance(|block, covariance| {
            if let (Some(next), Some(with_next)) = (&after, &covariance.with_next) {
                let across = walking(with_next);
                increments[block] =
                    walking(next) + walking(&covariance.own) - &across - across.transpose();
            }
            after = Some(covariance.own.clone());
        });
        increments
    }

    /// Visits the covariance of each block's slow states, from the last block back.
    ///
    /// Computes only the blocks of the inverse that this needs (Rauch, Tung & Striebel 1965).
    pub fn each_covariance(&self, mut visit: impl FnMut(usize, &SlowCovariance)) {
        let constants = self.constants_covariance();
        let mut after: Option<SlowCovariance> = None;
        for chunk in self.matrix.chunks().rev() {
            for (block, rows) in chunk.clone().zip(self.rows(chunk).iter()).rev() {
                let covariance = slow_covariance(rows, self.shape, after.as_ref(), &constants);
                visit(block, &covariance);
                after = Some(covariance);
            }
        }
    }
}

/// The chain, eliminated from its first block on.
pub struct ChainElimination<'a> {
    priors: &'a SlowPrecisions,
    shape: RowShape,
    /// The row that was eliminated last, and the memory of the next one.
    before: Option<FactorRow>,
    next: FactorRow,
    /// Gram matrix of the border, by rows.
    gram: Vec<f64>,
    ln_determinant: f64,
}

impl<'a> ChainElimination<'a> {
    pub fn new(shape: RowShape, priors: &'a SlowPrecisions) -> Self {
        let gram = vec![0.0; shape.border * shape.border];
        let ln_determinant = -priors.ln_determinant;
        Self { priors, shape, before: None, next: FactorRow::new(), gram, ln_determinant }
    }

    /// Eliminates the next block, and returns its row of the factor; `None` if it is not positive definite.
    pub fn eliminate(&mut self, row: &ChainRow, block: usize) -> Option<&FactorRow> {
        let (rows, shape) = (&mut self.next, self.shape);
        factor_row(row, (self.priors, shape), block, self.before.as_ref(), rows)?;
        add_border_gram(&mut self.gram, rows, shape);
        let diagonal = rows.iter().step_by(shape.width() + 1);
        self.ln_determinant += diagonal.map(|pivot| 2.0 * pivot.ln()).sum::<f64>();
        let oldest = self.before.take().unwrap_or_default();
        Some(self.before.insert(std::mem::replace(rows, oldest)))
    }

    /// Factor of the constants once all blocks are eliminated, and the logarithm of the determinant less that of the slow priors.
    pub fn constants(
        self,
        corner: &ConstantsMatrix,
        information: &ConstantsMatrix,
    ) -> Option<(ConstantsFactor, f64)> {
        let mut schur_complement = corner + information;
        for j in 0..schur_complement.ncols() {
            for i in 0..schur_complement.nrows() {
                schur_complement[(i, j)] -= self.gram[self.shape.border * i.min(j) + i.max(j)];
            }
        }
        let constants = schur_complement.cholesky()?;
        let ln_determinant = self.ln_determinant + constants.ln_determinant();
        ln_determinant.is_finite().then_some((constants, ln_determinant))
    }
}

/// Writes the row of the factor for a block to `rows`, given that of the block before it; `None` if it is not positive definite.
fn factor_row(
    data: &ChainRow,
    (priors, shape): (&SlowPrecisions, RowShape),
    block: usize,
    before: Option<&FactorRow>,
    rows: &mut FactorRow,
) -> Option<()> {
    rows.resize(shape.numbers(), 0.0);
    let (size, constants) = (shape.size, data.border.nrows());
    for (i, row) in rows.chunks_exact_mut(shape.width()).enumerate() {
        let (own, border) = row.split_at_mut(shape.first_of_border());
        let (own, next) = own.split_at_mut(size);
        own.copy_from_slice(&data.diagonal.as_slice()[size * i..][..size]);
        next.copy_from_slice(&data.next.as_slice()[size * i..][..size]);
        let (by_constants, rest) = border.split_at_mut(constants);
        by_constants.copy_from_slice(&data.border.as_slice()[constants * i..][..constants]);
        rest.fill(0.0);
    }
    priors.add_to_row(block, rows, shape);
    if let Some(before) = before {
        update(before, rows, shape, 1);
    }
    factorise(rows, shape).then_some(())
}

/// A right-hand side during elimination: slow states block by block, and the constants.
struct RightHandSide {
    shape: RowShape,
    slow: Vec<f64>,
    constants: Vec<f64>,
}

impl RightHandSide {
    fn new(right: &ChainVector, shape: RowShape) -> Self {
        let slow = right.slow.iter().flat_map(|slow| slow.iter().copied()).collect();
        let mut constants = right.constants.as_slice().to_vec();
        constants.resize(shape.border, 0.0);
        Self { shape, slow, constants }
    }

    /// The states of a block, followed by those of the next one.
    fn own_and_next(slow: &mut [f64], block: usize, shape: RowShape) -> &mut [f64] {
        let end = slow.len().min(shape.size * (block + 2));
        &mut slow[shape.size * block..end]
    }

    fn forward(&mut self, block: usize, rows: &FactorRow) {
        let own = Self::own_and_next(&mut self.slow, block, self.shape);
        let (own, next) = own.split_at_mut(self.shape.size);
        forward_substitute(rows, self.shape, own, next, &mut self.constants);
    }

    fn back(&mut self, block: usize, rows: &FactorRow) {
        let own = Self::own_and_next(&mut self.slow, block, self.shape);
        back_substitute(rows, self.shape, own, &self.constants);
    }

    fn into_vector(self, layout: &Layout) -> ChainVector {
        let slow = self.slow.chunks_exact(self.shape.size).map(|slow| slow.to_vec().into());
        let constants = Constants::from_column_slice(&self.constants[..layout.constants]);
        ChainVector { slow: slow.collect(), constants }
    }
}

/// Covariance of a block's slow states, from its row, that of the next block, and that of the constants.
fn slow_covariance(
    rows: &FactorRow,
    shape: RowShape,
    after: Option<&SlowCovariance>,
    constants: &ConstantsMatrix,
) -> SlowCovariance {
    let size = shape.size;
    let part = |first: usize, columns: usize| {
        DMatrix::from_fn(size, columns, |i, j| rows[shape.width() * i + first + j])
    };
    let own = part(0, size).upper_triangle();
    let identity = SlowMatrix::identity(size, size);
    let inverse = own.solve_upper_triangular(&identity).unwrap_or(identity);
    // s_b = by_next · s_b+1 + by_constants · θ + noise.
    let by_next = -&inverse * part(size, size);
    let by_constants = -&inverse * part(2 * size, constants.ncols());
    let noise = &inverse * inverse.transpose();
    let mut with_constants = &by_constants * constants;
    let mut covariance = noise;
    let with_next = after.map(|next| {
        with_constants += &by_next * &next.with_constants;
        &by_next * &next.own + &by_constants * next.with_constants.transpose()
    });
    covariance += &with_constants * by_constants.transpose();
    if let Some(with_next) = &with_next {
        covariance += with_next * by_next.transpose();
    }
    SlowCovariance { own: covariance, with_constants, with_next }
}

#[cfg(test)]
mod tests {
    use crate::network::PerStation;
    use nalgebra::DVector;
    use rand::{RngExt, SeedableRng};

    use super::super::block_jacobians::BlockJacobians;
    use super::super::chain::tests::without_stored_rows;
    use super::super::drive::Drive;
    use super::super::motion_band::BlockEquations;
    use super::super::random_walks::{GaussMarkov, SlowPriors};
    use super::super::state_vector::tests::layout;
    use super::super::station_model::MeanSight;
    use super::*;

    /// A chain of blocks with random mean sights and random information.
    fn chain(blocks: usize) -> (ChainMatrix, SlowPrecisions) {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let mut random = || rng.random_range(-1.0..1.0);
        let mut mean_sight = || {
            let mut vector = || nalgebra::Vector3::from_fn(|_, _| random());
            MeanSight {
                along: vector(),
                side: vector(),
                up: vector(),
                point_m: vector(),
                corrections_m: (0..6).map(|_| vector()).collect(),
            }
        };
        let layout = layout(3);
        let drive = Drive {
            layout: Arc::clone(&layout),
            segments: Vec::new(),
            mean_sights: (0..blocks)
                .map(|_| PerStation::from_fn(3, |_| Some(mean_sight())))
                .collect(),
            block_times_s: (0..blocks).map(|block| 6.0 * block as f64).collect(),
            coupled_to_next: (0..blocks).map(|block| block % 3 < 2 && block + 1 < blocks).collect(),
            spans_s: vec![[0.0, 6.0 * blocks as f64]],
            excess_jerk: Arc::default(),
        };
        let size = layout.block();
        let mut matrix = || DMatrix::from_fn(size, size, |_, _| random());
        let all = (0..blocks).map(|_| {
            let root = matrix();
            let information = &root * root.transpose() + DMatrix::identity(size, size) * 30.0;
            BlockEquations { information, with_next: matrix(), gradient: DVector::zeros(size) }
        });
        let all: Vec<BlockEquations> = all.collect();
        let priors = SlowPriors {
            settling: DMatrix::identity(8, 8),
            clocks_s2: 2.0,
            ranges: GaussMarkov { sigma_m: 0.5, correlation_s: 5.0 },
            across: GaussMarkov { sigma_m: 0.3, correlation_s: 9.0 },
            upward: GaussMarkov { sigma_m: 0.2, correlation_s: 7.0 },
            restarts_s: Vec::new(),
            restarted_s2: 1.0,
            station_steps: vec![2],
            clock_steps: vec![3],
        };
        let priors = SlowPrecisions::of_drive(&priors, &drive);
        let constants = Constants::zeros(layout.constants);
        let jacobians = BlockJacobians::new(&Arc::new(drive), &constants);
        (ChainMatrix::new(all, jacobians), priors.expect("positive variances"))
    }

    fn precision(value: f64) -> ConstantsMatrix {
        let size = layout(3).constants;
        ConstantsMatrix::from_diagonal_element(size, size, value)
    }

    fn dot(a: &ChainVector, b: &ChainVector) -> f64 {
        let slow: f64 = a.slow.iter().zip(&b.slow).map(|(a, b)| a.dot(b)).sum();
        slow + a.constants.dot(&b.constants)
    }

    #[test]
    fn increment_covariances_agree_with_solutions_for_unit_vectors() {
        const BLOCKS: usize = 5;
        let (data, priors) = chain(BLOCKS);
        let data = Arc::new(data);
        let layout = layout(3);
        let any = ChainVector::zeros(&layout, BLOCKS);
        let (factor, _) =
            ChainFactor::new(&data, &precision(1.0), &priors, &any).expect("definite");
        let walks = factor.increment_covariances();
        assert_eq!(walks.len(), BLOCKS - 1);
        for (index, found) in walks.iter().enumerate() {
            for k in 0..layout.slow_ranges() {
                let mut walked = ChainVector::zeros(&layout, BLOCKS);
                (walked.slow[index + 1][k], walked.slow[index][k]) = (1.0, -1.0);
                let solved = factor.solve_one(&walked);
                let expected = &solved.slow[index + 1] - &solved.slow[index];
                let off = found.column(k) - expected.rows(0, layout.slow_ranges());
                assert!(off.amax() < 1e-12, "{index}, {k}: {off}");
            }
        }
    }

    #[test]
    fn a_solution_solves_the_normal_equations() {
        let (data, priors) = chain(7);
        let data = Arc::new(data);
        let precision = precision(2.0);
        let mut right = ChainVector::zeros(&layout(3), 7);
        right.slow.iter_mut().for_each(|slow| slow.fill(0.7));
        right.constants.fill(-0.3);
        let (factor, found) =
            ChainFactor::new(&data, &precision, &priors, &right).expect("definite");
        assert_eq!(found.slow, factor.solve_one(&right).slow);
        // xᵀHx is xᵀ times the right-hand side.
        let by_priors: f64 =
            (0..7).map(|block| found.slow[block].dot(&priors.multiply(&found.slow, block))).sum();
        let product = &data.multiply(std::slice::from_ref(&found))[0];
        let by_constants = found.constants.dot(&(precision * &found.constants));
        let square = dot(&found, product) + by_constants + by_priors;
        let pulled = dot(&found, &right);
        assert!((square - pulled).abs() < 1e-9 * pulled.abs(), "{square} {pulled}");
    }

    #[test]
    fn recomputed_rows_are_the_stored_rows() {
        let blocks = 2 * CHUNK + 7;
        let (data, priors) = chain(blocks);
        let kept = Arc::new(data);
        let again = Arc::new(without_stored_rows(&kept));
        let precision = precision(2.0);
        let mut right = ChainVector::zeros(&layout(3), blocks);
        right.slow.iter_mut().enumerate().for_each(|(block, slow)| slow.fill(block as f64));
        let of = |data| ChainFactor::new(data, &precision, &priors, &right).expect("definite");
        let ((factor, by), (mut other, by_other)) = (of(&kept), of(&again));
        other.stored = Vec::new();
        assert_eq!(by_other.slow, other.solve_one(&right).slow);
        assert_eq!((&by.slow, &by.constants), (&by_other.slow, &by_other.constants));
        let [kept, again] = [kept, again].map(|matrix| matrix.multiply(std::slice::from_ref(&by)));
        assert_eq!((&kept[0].slow, &kept[0].constants), (&again[0].slow, &again[0].constants));
        assert_eq!(factor.increment_covariances(), other.increment_covariances());
    }
}
