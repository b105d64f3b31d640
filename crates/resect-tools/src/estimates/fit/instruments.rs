//! Information on a lever arm without the noise of orientations.
//!
//! The lever arm turns with the body. Derivatives by the orientations of the estimate contain their noise, which looks like motion: on a
//! flat drive it would determine a lever arm alone. The ground truth has its own noise, which is in the residuals. The noise of one is
//! independent of the other, so the estimate's derivatives Z are instruments for the ground truth's J. Against positions, Z has the orientations
//! between the poses before and after, and J that of the pose. With the residual r and its
//! information W, and N = Zᵀ W Z and M = Zᵀ W J, the information is Mᵀ N⁻¹ M, and the gradient Mᵀ N⁻¹ Zᵀ W r (two-stage least squares:
//! Theil 1953, Fuller 1987 section 2.4).

use nalgebra::{DMatrix, DVector};

use super::unknowns::{CLOCK, UNKNOWNS};
use resect_core::statistics::sandwich;

/// Sums of a block of time over the innovations.
#[derive(Clone)]
pub struct FilteredBlock {
    /// By the instruments twice.
    pub information: DMatrix<f64>,
    /// By the instruments, and by the lever arm with the derivatives of the residuals.
    pub by_residual: DMatrix<f64>,
    pub gradient: DVector<f64>,
}

/// Share of a diagonal element that is added to it, so that an unknown which nothing determines does not matter.
const RIDGE: f64 = 1e-9;

/// Returns the blocks of the open unknowns by their instruments, and the matrix Mᵀ N⁻¹ that transforms gradients.
pub fn by_instruments(
    blocks: &[FilteredBlock],
    open: &[usize],
) -> (Vec<sandwich::Block>, DMatrix<f64>) {
    let cross = |block: &FilteredBlock| {
        let mut cross = block.information.clone();
        cross.columns_mut(0, CLOCK).copy_from(&block.by_residual);
        cross.select_rows(open).select_columns(open)
    };
    let mut instruments = DMatrix::zeros(UNKNOWNS, UNKNOWNS);
    blocks.iter().for_each(|block| instruments += &block.information);
    let mut instruments = instruments.select_rows(open).select_columns(open);
    let crosses: Vec<DMatrix<f64>> = blocks.iter().map(cross).collect();
    let mut sum = DMatrix::zeros(open.len(), open.len());
    crosses.iter().for_each(|cross| sum += cross);
    let ridge = instruments.diagonal().map(|element| RIDGE * element + f64::MIN_POSITIVE);
    instruments += DMatrix::from_diagonal(&ridge);
    let identity = || DMatrix::identity(open.len(), open.len());
    let transform =
        instruments.cholesky().map_or_else(identity, |root| root.solve(&sum).transpose());
    let transformed = crosses.iter().zip(blocks).map(|(cross, block)| {
        let information = &transform * cross;
        sandwich::Block {
            information: 0.5 * (&information + information.transpose()),
            gradient: &transform * block.gradient.select_rows(open),
        }
    });
    (transformed.collect(), transform)
}
