//! Cholesky factor of the chain's normal matrix with the priors, its solutions, and the covariance of constants and slow states.
//!
//! The slow states are eliminated block by block, as in a Kalman smoother (Rauch, Tung & Striebel 1965), which leaves the
//! constants. The rows of a long drive's factor are not stored but recomputed, some blocks at a time.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::{ArrayStorage, Cholesky, Const, SMatrix};

use super::chain::{
    CHUNK, ChainMatrix, ChainRow, ChainVectors, MOST_STORED_BLOCKS, SlowByConstants,
};
use super::random_walks::{SlowMatrix, SlowPrecisions, WalkMatrix};
use super::state_vector::{CONSTANTS, ConstantsMatrix, SLOW, SLOW_RANGES};
use crate::linear_algebra::block_tridiagonal::{
    BlockRow, add_border_gram, back_substitute, eliminate_block, forward_substitute,
};

const ROW: usize = 2 * SLOW + CONSTANTS;

/// Block row of the factor.
pub type FactorRow = BlockRow<SLOW, ROW>;
const EMPTY_ROW: FactorRow = [[0.0; ROW]; SLOW];
type ConstantsFactor = Cholesky<f64, Const<CONSTANTS>>;

/// Factorised normal matrix of data and priors.
pub struct ChainFactor {
    matrix: Arc<ChainMatrix>,
    pub priors: SlowPrecisions,
    /// Rows of the first blocks.
    stored: Vec<FactorRow>,
    /// The row before each chunk of blocks, from which rows that are not stored are recomputed.
    before_chunks: Vec<Option<FactorRow>>,
    constants: ConstantsFactor,
}

/// Covariance of the slow states of a block.
pub struct SlowCovariance {
    pub own: SlowMatrix,
    pub with_constants: SlowByConstants,
    /// Covariance with the states of the next block; `None` for the last.
    pub with_next: Option<SlowMatrix>,
}

impl ChainFactor {
    /// Factorises, and solves for a right-hand side; `None` if the matrix is not positive definite.
    pub fn new<const K: usize>(
        matrix: &Arc<ChainMatrix>,
        information: &ConstantsMatrix,
        priors: &SlowPrecisions,
        right: ChainVectors<K>,
    ) -> Option<(Self, ChainVectors<K>)> {
        let mut stored = Vec::with_capacity(matrix.len().min(MOST_STORED_BLOCKS));
        let mut before_chunks = Vec::new();
        let mut elimination = ChainElimination::new(priors);
        let mut right = RightHandSide::new(right);
        for chunk in matrix.chunks() {
            before_chunks.push(elimination.before.as_deref().copied());
            for (block, row) in chunk.clone().zip(matrix.rows(chunk).iter()) {
                let rows = elimination.eliminate(row, block)?;
                right.forward(block, rows);
                if block < MOST_STORED_BLOCKS {
                    stored.push(*rows);
                }
            }
        }
        let (constants, _) = elimination.constants(&matrix.constants, information)?;
        let (matrix, priors) = (Arc::clone(matrix), priors.clone());
        let factor = Self { matrix, priors, stored, before_chunks, constants };
        let solution = factor.backward(right);
        Some((factor, solution))
    }

    /// Returns the rows of one chunk of [`ChainMatrix::chunks`].
    fn rows(&self, blocks: Range<usize>) -> Cow<'_, [FactorRow]> {
        if let Some(stored) = self.stored.get(blocks.clone()) {
            return Cow::Borrowed(stored);
        }
        let mut before = self.before_chunks[blocks.start / CHUNK];
        let rows = self.matrix.rows(blocks.clone());
        // The same rows were positive definite before.
        let factorised = |(block, row)| {
            let mut own = EMPTY_ROW;
            factor_row(row, &self.priors, block, before.as_ref(), &mut own)?;
            before = Some(own);
            before
        };
        blocks.zip(rows.iter()).map_while(factorised).collect()
    }

    /// Covariance of the constants.
    pub fn constants_covariance(&self) -> ConstantsMatrix {
        self.constants.inverse()
    }

    /// Returns the solution for a right-hand side.
    pub fn solve<const K: usize>(&self, right: ChainVectors<K>) -> ChainVectors<K> {
        let mut right = RightHandSide::new(right);
        for chunk in self.matrix.chunks() {
            let rows = self.rows(chunk.clone());
            chunk.zip(rows.iter()).for_each(|(block, rows)| right.forward(block, rows));
        }
        self.backward(right)
    }

    /// Back substitution.
    fn backward<const K: usize>(&self, right: RightHandSide<K>) -> ChainVectors<K> {
        let RightHandSide { mut slow, constants } = right;
        let by_column = SMatrix::<f64, K, CONSTANTS>::from_data(ArrayStorage(constants));
        let mut solution = by_column.transpose();
        self.constants.solve_mut(&mut solution);
        let constants = solution.transpose().data.0;
        for chunk in self.matrix.chunks().rev() {
            for (block, rows) in chunk.clone().zip(self.rows(chunk).iter()).rev() {
                let (own, next) = slow[block..].split_first_mut().expect("a block");
                back_substitute(rows, own, next.first(), &constants);
            }
        }
        let by_column = |rows| SMatrix::<f64, K, SLOW>::from_data(ArrayStorage(rows)).transpose();
        ChainVectors { slow: slow.into_iter().map(by_column).collect(), constants: solution }
    }

    /// Covariance of the increment of the random walks from each block to the next.
    pub fn increment_covariances(&self) -> Vec<WalkMatrix> {
        let walking =
            |block: &SlowMatrix| block.fixed_view::<SLOW_RANGES, SLOW_RANGES>(0, 0).into_owned();
        let mut increments = vec![WalkMatrix::zeros(); self.matrix.len().saturating_sub(1)];
        let mut after: Option<SlowMatrix> = None;
        self.each_covariance(|block, covariance| {
            if let (Some(next), Some(with_next)) = (after, &covariance.with_next) {
                let across = walking(with_next);
                increments[block] =
                    walking(&next) + walking(&covariance.own) - across - across.transpose();
            }
            after = Some(covariance.own);
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
                let covariance = slow_covariance(rows, after.as_ref(), &constants);
                visit(block, &covariance);
                after = Some(covariance);
            }
        }
    }
}

/// The chain, eliminated from its first block on.
pub struct ChainElimination<'a> {
    priors: &'a SlowPrecisions,
    /// The row that was eliminated last, and the memory of the next one.
    before: Option<Box<FactorRow>>,
    next: Box<FactorRow>,
    /// Gram matrix of the border.
    gram: [[f64; CONSTANTS]; CONSTANTS],
    ln_determinant: f64,
}

impl<'a> ChainElimination<'a> {
    pub fn new(priors: &'a SlowPrecisions) -> Self {
        let gram = [[0.0; CONSTANTS]; CONSTANTS];
        let next = Box::new(EMPTY_ROW);
        Self { priors, before: None, next, gram, ln_determinant: -priors.ln_determinant }
    }

    /// Eliminates the next block, and returns its row of the factor; `None` if it is not positive definite.
    pub fn eliminate(&mut self, row: &ChainRow, block: usize) -> Option<&FactorRow> {
        let rows = &mut self.next;
        factor_row(row, self.priors, block, self.before.as_deref(), rows)?;
        add_border_gram(&mut self.gram, rows);
        self.ln_determinant += (0..SLOW).map(|i| 2.0 * rows[i][i].ln()).sum::<f64>();
        let oldest = self.before.take().unwrap_or_else(|| Box::new(EMPTY_ROW));
        Some(self.before.insert(std::mem::replace(rows, oldest)))
    }

    /// Factor of the constants once all blocks are eliminated, and the logarithm of the determinant less that of the slow priors.
    pub fn constants(
        self,
        corner: &ConstantsMatrix,
        information: &ConstantsMatrix,
    ) -> Option<(ConstantsFactor, f64)> {
        let gram = ConstantsMatrix::from_fn(|i, j| self.gram[i.min(j)][i.max(j)]);
        let schur_complement = corner + information - gram;
        let constants = schur_complement.cholesky()?;
        let ln_determinant = self.ln_determinant + constants.ln_determinant();
        ln_determinant.is_finite().then_some((constants, ln_determinant))
    }
}

/// Writes the row of the factor for a block to `rows`, given that of the block before it; `None` if it is not positive definite.
fn factor_row(
    data: &ChainRow,
    priors: &SlowPrecisions,
    block: usize,
    before: Option<&FactorRow>,
    rows: &mut FactorRow,
) -> Option<()> {
    let diagonal = data.diagonal + priors.diagonal(block);
    let upper = data.upper + priors.upper(block);
    eliminate_block(&diagonal, &upper, &data.border, before, rows)
}

/// A right-hand side during elimination, by row, so that all columns are solved at once.
struct RightHandSide<const K: usize> {
    slow: Vec<[[f64; K]; SLOW]>,
    constants: [[f64; K]; CONSTANTS],
}

impl<const K: usize> RightHandSide<K> {
    fn new(right: ChainVectors<K>) -> Self {
        let by_row = |slow: SMatrix<f64, SLOW, K>| slow.transpose().data.0;
        Self {
            slow: right.slow.into_iter().map(by_row).collect(),
            constants: right.constants.transpose().data.0,
        }
    }

    fn forward(&mut self, block: usize, rows: &FactorRow) {
        let (own, next) = self.slow[block..].split_first_mut().expect("a block");
        forward_substitute(rows, own, next.first_mut(), &mut self.constants);
    }
}

/// Covariance of a block's slow states, from its row, that of the next block, and that of the constants.
fn slow_covariance(
    rows: &FactorRow,
    after: Option<&SlowCovariance>,
    constants: &ConstantsMatrix,
) -> SlowCovariance {
    let own = SlowMatrix::from_fn(|i, j| if j < i { 0.0 } else { rows[i][j] });
    let inverse =
        own.solve_upper_triangular(&SlowMatrix::identity()).unwrap_or_else(SlowMatrix::identity);
    // s_b = by_next · s_b+1 + by_constants · θ + noise.
    let by_next = -inverse * SlowMatrix::from_fn(|i, j| rows[i][SLOW + j]);
    let by_constants = -inverse * SlowByConstants::from_fn(|i, j| rows[i][2 * SLOW + j]);
    let noise = inverse * inverse.transpose();
    let mut with_constants = by_constants * constants;
    let mut covariance = noise;
    let with_next = after.map(|next| {
        with_constants += by_next * next.with_constants;
        by_next * next.own + by_constants * next.with_constants.transpose()
    });
    covariance += with_constants * by_constants.transpose();
    if let Some(with_next) = &with_next {
        covariance += with_next * by_next.transpose();
    }
    SlowCovariance { own: covariance, with_constants, with_next }
}

#[cfg(test)]
mod tests {
    use crate::network::PerStation;
    use nalgebra::SMatrix;
    use rand::{RngExt, SeedableRng};

    use super::super::block_jacobians::BlockJacobians;
    use super::super::chain::tests::without_stored_rows;
    use super::super::drive::Drive;
    use super::super::motion_band::BlockEquations;
    use super::super::random_walks::{GaussMarkov, SlowPriors};
    use super::super::state_vector::{BLOCK, Constants};
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
                up_m: vector(),
                side_m: vector(),
            }
        };
        let drive = Drive {
            segments: Vec::new(),
            mean_sights: (0..blocks).map(|_| PerStation::from_fn(3, |_| mean_sight())).collect(),
            block_times_s: (0..blocks).map(|block| 6.0 * block as f64).collect(),
            coupled_to_next: (0..blocks).map(|block| block % 3 < 2 && block + 1 < blocks).collect(),
            spans_s: vec![[0.0, 6.0 * blocks as f64]],
        };
        let mut matrix = || SMatrix::<f64, BLOCK, BLOCK>::from_fn(|_, _| random());
        let all = (0..blocks).map(|_| {
            let root = matrix();
            let information = root * root.transpose() + SMatrix::identity() * 30.0;
            BlockEquations { information, with_next: matrix(), ..BlockEquations::ZERO }
        });
        let all: Vec<BlockEquations> = all.collect();
        let priors = SlowPriors {
            settling: SMatrix::identity(),
            clocks_s2: 2.0,
            ranges: GaussMarkov { sigma_m: 0.5, correlation_s: 5.0 },
            across: GaussMarkov { sigma_m: 0.3, correlation_s: 9.0 },
            upward: GaussMarkov { sigma_m: 0.2, correlation_s: 7.0 },
            restarts_s: Vec::new(),
            restarted_s2: 1.0,
            station_steps: vec![2],
            clock_steps: vec![3],
        };
        let priors = SlowPrecisions::new(&priors, &drive.block_times_s);
        let jacobians = BlockJacobians::new(&Arc::new(drive), &Constants::zeros());
        (ChainMatrix::new(all, jacobians), priors.expect("positive variances"))
    }

    #[test]
    fn increment_covariances_agree_with_solutions_for_unit_vectors() {
        const BLOCKS: usize = 5;
        let (data, priors) = chain(BLOCKS);
        let data = Arc::new(data);
        let any = ChainVectors::<1>::zeros(BLOCKS);
        let (factor, _) =
            ChainFactor::new(&data, &ConstantsMatrix::identity(), &priors, any).expect("definite");
        let walks = factor.increment_covariances();
        assert_eq!(walks.len(), BLOCKS - 1);
        for (index, found) in walks.iter().enumerate() {
            let mut walked = ChainVectors::<SLOW_RANGES>::zeros(BLOCKS);
            for k in 0..SLOW_RANGES {
                walked.slow[index + 1][(k, k)] = 1.0;
                walked.slow[index][(k, k)] = -1.0;
            }
            let solved = factor.solve(walked);
            let expected = solved.slow[index + 1] - solved.slow[index];
            let expected = expected.fixed_rows::<SLOW_RANGES>(0);
            assert!((found - expected).amax() < 1e-12, "{index}: {found} {expected}");
        }
    }

    #[test]
    fn a_solution_solves_the_normal_equations() {
        let (data, priors) = chain(7);
        let data = Arc::new(data);
        let precision = ConstantsMatrix::from_diagonal_element(2.0);
        let mut right = ChainVectors::<1>::zeros(7);
        right.slow.iter_mut().for_each(|slow| slow.fill(0.7));
        right.constants.fill(-0.3);
        let (factor, found) =
            ChainFactor::new(&data, &precision, &priors, right.clone()).expect("definite");
        assert_eq!(found.slow, factor.solve(right.clone()).slow);
        // xᵀHx is xᵀ times the right-hand side.
        let by_priors: f64 =
            (0..7).map(|block| found.slow[block].dot(&priors.multiply(&found.slow, block))).sum();
        let square = data.quadratic_form(&found)[0]
            + found.constants.dot(&(precision * found.constants))
            + by_priors;
        let pulled: f64 = found.slow.iter().zip(&right.slow).map(|(a, b)| a.dot(b)).sum();
        let pulled = pulled + found.constants.dot(&right.constants);
        assert!((square - pulled).abs() < 1e-9 * pulled.abs(), "{square} {pulled}");
    }

    #[test]
    fn recomputed_rows_are_the_stored_rows() {
        let blocks = 2 * CHUNK + 7;
        let (data, priors) = chain(blocks);
        let kept = Arc::new(data);
        let again = Arc::new(without_stored_rows(&kept));
        let precision = ConstantsMatrix::from_diagonal_element(2.0);
        let mut right = ChainVectors::<2>::zeros(blocks);
        right.slow.iter_mut().enumerate().for_each(|(block, slow)| slow.fill(block as f64));
        let of =
            |data| ChainFactor::new(data, &precision, &priors, right.clone()).expect("definite");
        let ((factor, by), (mut other, by_other)) = (of(&kept), of(&again));
        other.stored = Vec::new();
        assert_eq!(by_other.slow, other.solve(right.clone()).slow);
        assert_eq!((&by.slow, &by.constants), (&by_other.slow, &by_other.constants));
        assert_eq!(kept.quadratic_form(&by), again.quadratic_form(&by));
        assert_eq!(factor.increment_covariances(), other.increment_covariances());
    }
}
