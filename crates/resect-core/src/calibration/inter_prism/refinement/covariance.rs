//! How far a refined answer may be off.

use nalgebra::{DMatrix, DVector};

use super::model::{CONSTANT, DISTANCES, DRIFTS, Matrix, State, TILTS, reduced, reduced_vector};
use super::sums::Sums;
use crate::calibration::instrument::{PRISM_CONSTANT_SIGMA_M, TILT_SIGMA_RAD};
use crate::statistics::sandwich;
use crate::statistics::sandwich::{Block, Prior};

/// How far the noise's share of the variances may be off (1 σ); what it pulls the answer by is uncertain as much.
const NOISE_SHARE_SIGMA: f64 = 0.5;

/// Covariance of the estimated unknowns: the sandwich with their priors. Distances and tilts that are not estimated are
/// not known exactly either: their σ is propagated, since an error of theirs acts on every triplet alike and no
/// residual shows it.
pub fn covariance(
    sums: &Sums,
    precision: &State,
    lambda: f64,
    places: &[usize],
    distance_sigma_m: f64,
) -> Option<Matrix> {
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
    let priors = Matrix::from_diagonal(&(lambda * precision));
    let inverse: DMatrix<f64> = reduced(&(sums.hessian + priors), places).cholesky()?.inverse();
    let mut add = |pull: DVector<f64>| {
        let moved = &inverse * pull;
        small += &moved * moved.transpose();
    };
    let held = (DISTANCES..DRIFTS).chain([CONSTANT]).filter(|place| !places.contains(place));
    for held in held {
        let sigma = match held {
            CONSTANT => PRISM_CONSTANT_SIGMA_M,
            TILTS.. => TILT_SIGMA_RAD,
            _ => distance_sigma_m,
        };
        add(reduced_vector(&sums.hessian.column(held).into_owned(), places) * sigma);
    }
    add(reduced_vector(&sums.by_noise, places) * NOISE_SHARE_SIGMA);
    let mut full = Matrix::zeros();
    for (i, row) in places.iter().enumerate() {
        for (j, column) in places.iter().enumerate() {
            full[(*row, *column)] = small[(i, j)];
        }
    }
    full.iter().all(|entry| entry.is_finite()).then_some(full)
}
