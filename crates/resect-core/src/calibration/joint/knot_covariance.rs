//! Covariance of an eliminated motion: the blocks of the inverse for four consecutive knots, on which an instant depends.
//!
//! Computed from the last knot back, as by a smoother (Rauch, Tung & Striebel 1965): the coefficients of a knot are its row's factors
//! times those of the next three and of the blocks, plus noise of its own.

use nalgebra::DMatrix;

use super::knot_grid::ORDER;
use super::motion_band::{FIRST_BLOCK, MotionBand};

/// Covariance of four consecutive knots.
pub struct KnotCovariance {
    pub first: usize,
    /// Covariance of their coefficients given the unknowns of the blocks (m²), square.
    pub covariance: DMatrix<f64>,
    /// Jacobian by the unknowns of their block if its neighbours change alike.
    pub by_block: DMatrix<f64>,
}

/// Visits four knots after the other, from the last back.
pub fn each_knot_covariance(band: &MotionBand, mut visit: impl FnMut(&KnotCovariance)) {
    let (shape, block) = (band.shape(), band.block());
    let (local, size) = (shape.size, shape.first_of_border());
    let rest = size - local;
    let count = band.knots().len();
    let mut knots = KnotCovariance {
        first: count,
        covariance: DMatrix::zeros(size, size),
        by_block: DMatrix::zeros(size, block),
    };
    for (knot, rows) in band.knots().enumerate().rev() {
        let row = |i: usize| &rows[shape.width() * i..][..shape.width()];
        let own = DMatrix::from_fn(local, local, |i, j| if j < i { 0.0 } else { row(i)[j] });
        // The factor of a positive definite matrix has no zero on its diagonal.
        let inverse = own.solve_upper_triangular(&DMatrix::identity(local, local));
        let inverse = inverse.unwrap_or_else(|| DMatrix::identity(local, local));
        let forward = -&inverse * DMatrix::from_fn(local, rest, |i, j| row(i)[local + j]);
        let border = DMatrix::from_fn(local, block, |i, j| {
            let blocks = &row(i)[size + FIRST_BLOCK..];
            blocks[j] + blocks[block + j]
        });
        let after = |all: &DMatrix<f64>, columns: usize| -> DMatrix<f64> {
            all.view((0, 0), (rest, columns)).into_owned()
        };
        let (of_rest, rest_by_block) =
            (after(&knots.covariance, rest), after(&knots.by_block, block));
        let with_rest = &forward * &of_rest;
        let own_covariance = &with_rest * forward.transpose() + &inverse * inverse.transpose();
        let own_covariance = 0.5 * (&own_covariance + own_covariance.transpose());
        let own_by_block = &forward * &rest_by_block - &inverse * border;
        knots.first = knot;
        knots.covariance.view_mut((0, 0), (local, local)).copy_from(&own_covariance);
        knots.covariance.view_mut((0, local), (local, rest)).copy_from(&with_rest);
        knots.covariance.view_mut((local, 0), (rest, local)).tr_copy_from(&with_rest);
        knots.covariance.view_mut((local, local), (rest, rest)).copy_from(&of_rest);
        knots.by_block.view_mut((0, 0), (local, block)).copy_from(&own_by_block);
        knots.by_block.view_mut((local, 0), (rest, block)).copy_from(&rest_by_block);
        if knot + ORDER <= count {
            visit(&knots);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::motion_band::tests::{BLOCK, KNOTS, LOCAL, example};
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
