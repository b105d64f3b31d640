//! Normal matrix, Hessian and gradient of the triplets, by block of time, and the Gauss–Newton step.

use std::ops::Range;

use multiversion::multiversion;

use super::model::{Linearised, Matrix, State, UNKNOWNS, reduced, reduced_vector};
use super::noise::WEIGHT_PER_M2;
use crate::statistics::robust::{Influence, huber};

/// Sums over the triplets of a block of time.
pub struct Block {
    /// Σ ψ'(r) J Jᵀ, on and below the diagonal.
    pub hessian: Matrix,
    /// Σ ψ(r) J, less the bias that noise causes.
    pub gradient: State,
}

/// Sums over the triplets of each block and of all.
pub struct Sums {
    pub blocks: Vec<Block>,
    /// Σ w J Jᵀ with w = ψ(r)/r.
    pub normal: Matrix,
    /// Σ ψ'(r) J Jᵀ.
    pub hessian: Matrix,
    /// Σ ψ(r) J, less the bias that noise causes.
    pub gradient: State,
    /// Bias of the gradient that noise causes.
    pub by_noise: State,
}

impl Sums {
    /// Sums the triplets, each at the state; `bend` is that of Huber's loss, in units of the stated noise.
    pub fn over(blocks: &[Range<usize>], each: &[Linearised], bend: f64) -> Self {
        let mut sums = Self {
            blocks: Vec::with_capacity(blocks.len()),
            normal: Matrix::zeros(),
            hessian: Matrix::zeros(),
            gradient: State::zeros(),
            by_noise: State::zeros(),
        };
        for range in blocks {
            let mut block = Block { hessian: Matrix::zeros(), gradient: State::zeros() };
            let mut by_noise = State::zeros();
            for Linearised { residual_m, derivative, noise_pull } in &each[range.clone()] {
                for pair in 0..3 {
                    let size = residual_m[pair].abs() * WEIGHT_PER_M2.sqrt();
                    let Influence { weight, slope } = huber(size, bend);
                    let (weight, slope) = (WEIGHT_PER_M2 * weight, WEIGHT_PER_M2 * slope);
                    let derivative = &derivative[pair];
                    add_square(block.hessian.as_mut_slice(), derivative.as_slice(), slope);
                    // Weight and slope are equal for most residuals.
                    if weight != slope {
                        add_square(
                            sums.normal.as_mut_slice(),
                            derivative.as_slice(),
                            weight - slope,
                        );
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

/// SIMD lanes of a column.
const LANES: usize = 4;

/// Adds w J Jᵀ on and below the diagonal. Half of the columns are zero for a pair, and are skipped.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
fn add_square(matrix: &mut [f64], derivative: &[f64], weight: f64) {
    let (rows, _) = derivative.as_chunks::<LANES>();
    for (place, column) in matrix.chunks_exact_mut(UNKNOWNS).enumerate() {
        let factor = weight * derivative[place];
        if factor == 0.0 {
            continue;
        }
        let (column, _) = column.as_chunks_mut::<LANES>();
        let first = place / LANES;
        for (into, row) in column[first..].iter_mut().zip(&rows[first..]) {
            for (into, row) in into.iter_mut().zip(row) {
                *into += factor * row;
            }
        }
    }
}

/// Returns λ, the weight of the priors; `None` where the data does not determine the transforms.
///
/// The leverage of each block is missing in it. The prior's weight need not be exact for σ to be
/// ([`crate::statistics::sandwich`]).
pub fn prior_weight(sums: &Sums) -> Option<f64> {
    let hessian = sums.hessian.fixed_view::<8, 8>(0, 0).into_owned();
    let inverse = hessian.cholesky()?.inverse();
    let of_block = |block: &Block| {
        let gradient = block.gradient.fixed_rows::<8>(0);
        gradient.dot(&(inverse * gradient))
    };
    Some((sums.blocks.iter().map(of_block).sum::<f64>() / 8.0).max(f64::MIN_POSITIVE))
}

/// Returns the step of the estimated unknowns, zero for the constrained ones; `None` where the matrix is not positive definite.
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
