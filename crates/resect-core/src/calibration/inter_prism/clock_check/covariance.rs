//! Covariance of the clock check.

use nalgebra::{DMatrix, DVector};

use super::model::{ClockCheckModel, State, reduced, reduced_vector};
use super::sums::ClockCheckSums;
use crate::calibration::instrument::TILT_SIGMA_RAD;
use crate::statistics::sandwich;
use crate::statistics::sandwich::{Block, Prior};

/// Relative standard deviation of the noise model, and of the bias that the noise causes.
const NOISE_SHARE_SIGMA: f64 = 0.5;

/// Returns the covariance of the estimated unknowns: the sandwich with their priors.
///
/// Tilts are not estimated. An error of a tilt affects every triplet alike and no residual shows it, so σ of the tilts is
/// propagated.
pub fn covariance(
    model: &ClockCheckModel,
    sums: &ClockCheckSums,
    precision: &State,
    lambda: f64,
    places: &[usize],
) -> Option<DMatrix<f64>> {
    let each: Vec<Block> = sums
        .blocks
        .iter()
        .map(|block| Block {
            information: reduced(&block.hessian, places),
            gradient: reduced_vector(&block.gradient, places),
        })
        .collect();
    let prior = Prior { precision: reduced_vector(precision, places), weight: lambda };
    let mut small = sandwich::covariance(&each, Some(&prior))?;
    let priors = DMatrix::from_diagonal(&(lambda * precision));
    let inverse = reduced(&(&sums.hessian + priors), places).cholesky()?.inverse();
    let mut add = |pull: DVector<f64>| {
        let moved = &inverse * pull;
        small += &moved * moved.transpose();
    };
    for tilt in model.tilts() {
        add(reduced_vector(&sums.hessian.column(tilt).into_owned(), places) * TILT_SIGMA_RAD);
    }
    add(reduced_vector(&sums.by_noise, places) * NOISE_SHARE_SIGMA);
    let mut full = DMatrix::zeros(model.order(), model.order());
    for (i, row) in places.iter().enumerate() {
        for (j, column) in places.iter().enumerate() {
            full[(*row, *column)] = small[(i, j)];
        }
    }
    full.iter().all(|entry| entry.is_finite()).then_some(full)
}
