//! Information on a lever arm without the noise of orientations.
//!
//! The lever arm turns with the body. Derivatives by the orientations of one trajectory contain their noise, which looks like motion: on a
//! flat drive it would determine a lever arm alone. The noise of one is independent of the other's, so the derivatives Z of one are instruments
//! for the derivatives J of the other. With the residual r and its information W, and N = Zᵀ W Z and M = Zᵀ W J, the information is
//! Mᵀ N⁻¹ M, and the gradient Mᵀ N⁻¹ Zᵀ W r (two-stage least squares: Theil 1953, Fuller 1987 section 2.4).
//!
//! The lever arm in the residual is turned by the orientations of J: those of Z would bring their noise into it. Errors of a trajectory's
//! positions and orientations have common causes, so Z is by the trajectory with less noise. Against positions, Z has the orientations between
//! the poses before and after, and J that of the pose.

use nalgebra::{DMatrix, DVector};

use super::unknowns::{BY_TRUTH, CLOCK};
use resect_core::statistics::sandwich;

/// Sums of a block of time over the innovations.
#[derive(Clone)]
pub struct FilteredBlock {
    /// By the columns of derivatives twice.
    pub information: DMatrix<f64>,
    pub gradient: DVector<f64>,
}

/// Share of a diagonal element that is added to it, so that an unknown which nothing determines does not matter.
const RIDGE: f64 = 1e-9;

/// Columns of the instruments and of the derivatives of the residuals for each open unknown.
pub struct Instruments {
    pub columns: Vec<usize>,
    by_residual: Vec<usize>,
}

impl Instruments {
    /// `are_of_truth` is true if the instruments of the lever arm are the ground truth's orientations.
    pub fn of(open: &[usize], are_of_truth: bool) -> Self {
        let both = open.iter().map(|unknown| match *unknown {
            lever if lever < CLOCK && are_of_truth => (BY_TRUTH + lever, lever),
            lever if lever < CLOCK => (lever, BY_TRUTH + lever),
            other => (other, other),
        });
        let (columns, by_residual) = both.unzip();
        Self { columns, by_residual }
    }
}

/// Returns true if the orientations of the ground truth have less noise than those of the estimate: information beyond the product of both.
pub fn truth_is_less_noisy(blocks: &[FilteredBlock]) -> bool {
    let noise = |first: usize| -> f64 {
        let element = |row: usize, column: usize| -> f64 {
            blocks.iter().map(|block| block.information[(row, column)]).sum()
        };
        let of_axis = |axis: usize| {
            let motion = element(axis, BY_TRUTH + axis);
            (element(first + axis, first + axis) - motion) / motion.abs().max(f64::MIN_POSITIVE)
        };
        (0..CLOCK).map(of_axis).sum()
    };
    noise(BY_TRUTH) < noise(0)
}

/// Returns the blocks of the open unknowns by their instruments, and the matrix Mᵀ N⁻¹ that transforms gradients.
pub fn by_instruments(
    blocks: &[FilteredBlock],
    instruments: &Instruments,
) -> (Vec<sandwich::Block>, DMatrix<f64>) {
    let Instruments { columns, by_residual } = instruments;
    let count = columns.len();
    let sum = |columns_of: &[usize]| {
        blocks.iter().fold(DMatrix::zeros(count, count), |sum, block| {
            sum + block.information.select_rows(columns).select_columns(columns_of)
        })
    };
    let mut squares = sum(columns);
    let ridge = squares.diagonal().map(|element| RIDGE * element + f64::MIN_POSITIVE);
    squares += DMatrix::from_diagonal(&ridge);
    let identity = || DMatrix::identity(count, count);
    let transform =
        squares.cholesky().map_or_else(identity, |root| root.solve(&sum(by_residual)).transpose());
    let transformed = blocks.iter().map(|block| {
        let cross = block.information.select_rows(columns).select_columns(by_residual);
        let information = &transform * cross;
        sandwich::Block {
            information: 0.5 * (&information + information.transpose()),
            gradient: &transform * block.gradient.select_rows(columns),
        }
    });
    (transformed.collect(), transform)
}
