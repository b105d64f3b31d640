//! Normal matrix, Hessian and gradient of the triplets by block of time, and the Gauss–Newton step.

use std::ops::Range;

use super::model::{Linearised, Matrix, State, reduced, reduced_vector};
use super::noise::WEIGHT_PER_M2;
use crate::linear_algebra::sums::add_outer_product;
use crate::statistics::robust::{Influence, huber};

/// Sums over the triplets of a block of time.
pub struct TimeBlock {
    /// Σ ψ'(r) J Jᵀ, the lower triangle with the diagonal.
    pub hessian: Matrix,
    /// Σ ψ(r) J, less the bias that noise causes.
    pub gradient: State,
}

/// Sums over the triplets of each block and of all.
pub struct ClockCheckSums {
    pub blocks: Vec<TimeBlock>,
    /// Σ w J Jᵀ with w = ψ(r)/r.
    pub normal: Matrix,
    /// Σ ψ'(r) J Jᵀ.
    pub hessian: Matrix,
    /// Σ ψ(r) J, less the bias that noise causes.
    pub gradient: State,
    /// Bias of the gradient that noise causes.
    pub by_noise: State,
}

impl ClockCheckSums {
    /// Sums the linearised triplets; `bend` is that of Huber's loss, in units of the stated noise.
    pub fn over(blocks: &[Range<usize>], each: &[Linearised], bend: f64) -> Self {
        let mut sums = Self {
            blocks: Vec::with_capacity(blocks.len()),
            normal: Matrix::zeros(),
            hessian: Matrix::zeros(),
            gradient: State::zeros(),
            by_noise: State::zeros(),
        };
        for range in blocks {
            let mut block = TimeBlock { hessian: Matrix::zeros(), gradient: State::zeros() };
            let mut by_noise = State::zeros();
            for Linearised { residual_m, derivative, noise_pull } in &each[range.clone()] {
                for pair in 0..3 {
                    let size = residual_m[pair].abs() * WEIGHT_PER_M2.sqrt();
                    let Influence { weight, slope } = huber(size, bend);
                    let (weight, slope) = (WEIGHT_PER_M2 * weight, WEIGHT_PER_M2 * slope);
                    let derivative = &derivative[pair];
                    add_outer_product(&mut block.hessian, derivative, slope);
                    // Weight and slope are equal for most residuals.
                    if weight != slope {
                        add_outer_product(&mut sums.normal, derivative, weight - slope);
                    }
                    block.gradient.axpy(weight * residual_m[pair], derivative, 1.0);
                    by_noise.axpy(slope, &noise_pull[pair], 1.0);
                }
            }
            block.gradient -= by_noise;
            sums.hessian += block.hessian;
            sums.gradient += block.gradient;
            sums.by_noise += by_noise;
            sums.blocks.push(block);
        }
        sums.normal += sums.hessian;
        sums.normal.fill_upper_triangle_with_lower_triangle();
        sums.hessian.fill_upper_triangle_with_lower_triangle();
        sums
    }
}

/// Returns λ, the weight of the priors; `None` if the data does not determine the transforms.
///
/// It neglects the leverage of each block. σ does not need an exact weight of the prior ([`crate::statistics::sandwich`]).
pub fn prior_weight(sums: &ClockCheckSums) -> Option<f64> {
    let hessian = sums.hessian.fixed_view::<8, 8>(0, 0).into_owned();
    let inverse = hessian.cholesky()?.inverse();
    let of_block = |block: &TimeBlock| {
        let gradient = block.gradient.fixed_rows::<8>(0);
        gradient.dot(&(inverse * gradient))
    };
    Some((sums.blocks.iter().map(of_block).sum::<f64>() / 8.0).max(f64::MIN_POSITIVE))
}

/// Returns the step of the estimated unknowns, zero for the constrained ones; `None` if the matrix is not positive definite.
pub fn step(
    matrix: &Matrix,
    precision: &State,
    lambda: f64,
    gradient: &State,
    places: &[usize],
) -> Option<State> {
    let matrix = matrix + Matrix::from_diagonal(&(lambda * precision));
    let step = reduced(&matrix, places).cholesky()?.solve(&reduced_vector(gradient, places));
    let mut full = State::zeros();
    for (place, value) in places.iter().zip(&step) {
        full[*place] = *value;
    }
    full.iter().all(|value| value.is_finite()).then_some(full)
}
