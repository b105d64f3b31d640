//! Normal matrix, Hessian and gradient of the triplets by block of time, and the Gauss–Newton step.

use std::ops::Range;

use nalgebra::DMatrix;

use super::model::{ClockCheckModel, LinearisedTriplets, State, reduced, reduced_vector};
use super::noise::WEIGHT_PER_M2;
use crate::linear_algebra::sums::add_outer_product;
use crate::statistics::robust::{Influence, huber};

/// Sums over the triplets of a block of time.
pub struct TimeBlock {
    /// Σ ψ'(r) J Jᵀ, the lower triangle with the diagonal.
    pub hessian: DMatrix<f64>,
    /// Σ ψ(r) J, less the bias that noise causes.
    pub gradient: State,
}

/// Sums over the triplets of each block and of all.
pub struct ClockCheckSums {
    pub blocks: Vec<TimeBlock>,
    /// Σ w J Jᵀ with w = ψ(r)/r.
    pub normal: DMatrix<f64>,
    /// Σ ψ'(r) J Jᵀ.
    pub hessian: DMatrix<f64>,
    /// Σ ψ(r) J, less the bias that noise causes.
    pub gradient: State,
    /// Bias of the gradient that noise causes.
    pub by_noise: State,
}

impl ClockCheckSums {
    /// Sums the linearised triplets; `bend` is that of Huber's loss, in units of the stated noise.
    pub fn over(blocks: &[Range<usize>], linearised: &LinearisedTriplets, bend: f64) -> Self {
        let order = linearised.order;
        let mut sums = Self {
            blocks: Vec::with_capacity(blocks.len()),
            normal: DMatrix::zeros(order, order),
            hessian: DMatrix::zeros(order, order),
            gradient: State::zeros(order),
            by_noise: State::zeros(order),
        };
        for range in blocks {
            let (hessian, gradient) = (DMatrix::zeros(order, order), State::zeros(order));
            let mut block = TimeBlock { hessian, gradient };
            let mut by_noise = State::zeros(order);
            let per_triplet = linearised.per_triplet;
            for row in range.start * per_triplet..range.end * per_triplet {
                let residual_m = linearised.residual_m[row];
                let size = residual_m.abs() * WEIGHT_PER_M2.sqrt();
                let Influence { weight, slope } = huber(size, bend);
                let (weight, slope) = (WEIGHT_PER_M2 * weight, WEIGHT_PER_M2 * slope);
                let derivative = linearised.derivative(row);
                add_outer_product(&mut block.hessian, derivative, slope);
                // Weight and slope are equal for most residuals.
                if weight != slope {
                    add_outer_product(&mut sums.normal, derivative, weight - slope);
                }
                add_scaled(&mut block.gradient, weight * residual_m, derivative);
                add_scaled(&mut by_noise, slope, linearised.noise_pull(row));
            }
            block.gradient -= &by_noise;
            sums.hessian += &block.hessian;
            sums.gradient += &block.gradient;
            sums.by_noise += by_noise;
            sums.blocks.push(block);
        }
        sums.normal += &sums.hessian;
        sums.normal.fill_upper_triangle_with_lower_triangle();
        sums.hessian.fill_upper_triangle_with_lower_triangle();
        sums
    }
}

fn add_scaled(sum: &mut State, factor: f64, row: &[f64]) {
    for (sum, value) in sum.iter_mut().zip(row) {
        *sum += factor * value;
    }
}

/// Returns λ, the weight of the priors; `None` if the data does not determine the transforms.
///
/// It neglects the leverage of each block. σ does not need an exact weight of the prior ([`crate::statistics::sandwich`]).
pub fn prior_weight(model: &ClockCheckModel, sums: &ClockCheckSums) -> Option<f64> {
    let poses = model.poses().len();
    let hessian = sums.hessian.view((0, 0), (poses, poses)).into_owned();
    let inverse = hessian.cholesky()?.inverse();
    let of_block = |block: &TimeBlock| {
        let gradient = block.gradient.rows(0, poses);
        gradient.dot(&(&inverse * gradient))
    };
    let trace: f64 = sums.blocks.iter().map(of_block).sum();
    Some((trace / poses as f64).max(f64::MIN_POSITIVE))
}

/// Returns the step of the estimated unknowns, zero for the constrained ones; `None` if the matrix is not positive definite.
pub fn step(
    matrix: &DMatrix<f64>,
    precision: &State,
    lambda: f64,
    gradient: &State,
    places: &[usize],
) -> Option<State> {
    let matrix = matrix + DMatrix::from_diagonal(&(lambda * precision));
    let step = reduced(&matrix, places).cholesky()?.solve(&reduced_vector(gradient, places));
    let mut full = State::zeros(gradient.len());
    for (place, value) in places.iter().zip(&step) {
        full[*place] = *value;
    }
    full.iter().all(|value| value.is_finite()).then_some(full)
}
