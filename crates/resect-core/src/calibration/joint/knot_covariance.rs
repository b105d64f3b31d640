//! Covariance of an eliminated motion: the blocks of the inverse for four consecutive knots, on which an instant depends.
//!
//! Computed from the last knot back, as by a smoother (Rauch, Tung & Striebel 1965): the coefficients of a knot are its row's factors
//! times those of the next three and of the blocks, plus noise of its own.

use nalgebra::{DMatrix, DMatrixView};

use super::knot_grid::ORDER;
use super::motion_band::{FIRST_BLOCK, MotionBand};
use super::state_vector::BLOCK;

/// Covariance of four consecutive knots.
pub struct KnotCovariance {
    pub first: usize,
    /// Covariance of their coefficients given the unknowns of the blocks (m²): 4 × `LOCAL` square.
    pub covariance: DMatrix<f64>,
    /// Jacobian by the unknowns of their block if its neighbours change alike: 4 × `LOCAL` by [`BLOCK`].
    pub by_block: DMatrix<f64>,
}

/// Visits four knots after the other, from the last back.
pub fn each_knot_covariance<const LOCAL: usize, const ROW: usize>(
    band: &MotionBand<LOCAL, ROW>,
    mut visit: impl FnMut(&KnotCovariance),
) {
    let size = ORDER * LOCAL;
    let rest = size - LOCAL;
    let mut knots = KnotCovariance {
        first: band.rows().len(),
        covariance: DMatrix::zeros(size, size),
        by_block: DMatrix::zeros(size, BLOCK),
    };
    for (knot, rows) in band.rows().iter().enumerate().rev() {
        let own = DMatrix::from_fn(LOCAL, LOCAL, |i, j| if j < i { 0.0 } else { rows[i][j] });
        // The factor of a positive definite matrix has no zero on its diagonal.
        let inverse = own.solve_upper_triangular(&DMatrix::identity(LOCAL, LOCAL));
        let inverse = inverse.unwrap_or_else(|| DMatrix::identity(LOCAL, LOCAL));
        let forward = -&inverse * DMatrix::from_fn(LOCAL, rest, |i, j| rows[i][LOCAL + j]);
        let border = DMatrix::from_fn(LOCAL, BLOCK, |i, j| {
            let blocks = &rows[i][size + FIRST_BLOCK..];
            blocks[j] + blocks[BLOCK + j]
        });
        let after = |all: &DMatrix<f64>, columns: usize| -> DMatrix<f64> {
            let kept: DMatrixView<'_, f64> = all.view((0, 0), (rest, columns));
            kept.into_owned()
        };
        let (of_rest, rest_by_block) =
            (after(&knots.covariance, rest), after(&knots.by_block, BLOCK));
        let with_rest = &forward * &of_rest;
        let own_covariance = &with_rest * forward.transpose() + &inverse * inverse.transpose();
        let own_covariance = 0.5 * (&own_covariance + own_covariance.transpose());
        let own_by_block = &forward * &rest_by_block - &inverse * border;
        knots.first = knot;
        knots.covariance.view_mut((0, 0), (LOCAL, LOCAL)).copy_from(&own_covariance);
        knots.covariance.view_mut((0, LOCAL), (LOCAL, rest)).copy_from(&with_rest);
        knots.covariance.view_mut((LOCAL, 0), (rest, LOCAL)).tr_copy_from(&with_rest);
        knots.covariance.view_mut((LOCAL, LOCAL), (rest, rest)).copy_from(&of_rest);
        knots.by_block.view_mut((0, 0), (LOCAL, BLOCK)).copy_from(&own_by_block);
        knots.by_block.view_mut((LOCAL, 0), (rest, BLOCK)).copy_from(&rest_by_block);
        if knot + ORDER <= band.rows().len() {
            visit(&knots);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::motion_band::tests::{KNOTS, LOCAL, example};
    use super::*;

    #[test]
    fn covariances_of_four_knots_are_blocks_of_the_dense_inverse() {
        let (mut band, full, _) = example();
        assert!(band.eliminate());
        let dense = full.try_inverse().expect("definite");
        let locals = KNOTS * LOCAL;
        let block_gradients = dense.view((locals, locals), (BLOCK, BLOCK)).into_owned();
        let mut visited = 0;
        each_knot_covariance(&band, |knots| {
            let found =
                &knots.covariance + &knots.by_block * &block_gradients * knots.by_block.transpose();
            let (at, size) = (knots.first * LOCAL, ORDER * LOCAL);
            let expected = dense.view((at, at), (size, size));
            let off = (&found - expected).amax();
            assert!(off < 1e-9 * expected.amax(), "knots from {}: {off}", knots.first);
            visited += 1;
        });
        assert_eq!(visited, KNOTS - ORDER + 1);
    }
}
