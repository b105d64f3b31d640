//! What the triplets say about the unknowns at a state: sums over each block of time, and steps out of them.

use std::ops::Range;

use multiversion::multiversion;

use super::model::{Matrix, State, UNKNOWNS, distances, reduced, reduced_vector, transforms};
use super::noise::Noise;
use crate::calibration::Loss;
use crate::calibration::MovingTriplets;
use crate::statistics::robust::{self, Influence};

/// Sums over the triplets of a block of time, or of all blocks.
pub struct Sums {
    /// Σ w J Jᵀ with w = ψ(r)/r.
    pub normal: Matrix,
    /// Σ ψ'(r) J Jᵀ.
    pub hessian: Matrix,
    /// Σ ψ(r) J, less what noise alone makes of it.
    pub gradient: State,
    /// What noise alone makes of it.
    pub by_noise: State,
}

impl Sums {
    fn zeros() -> Self {
        Self {
            normal: Matrix::zeros(),
            hessian: Matrix::zeros(),
            gradient: State::zeros(),
            by_noise: State::zeros(),
        }
    }

    /// Sums over all blocks.
    pub fn over(blocks: &[Self]) -> Self {
        let mut all = Self::zeros();
        for block in blocks {
            all.normal += block.normal;
            all.hessian += block.hessian;
            all.gradient += block.gradient;
            all.by_noise += block.by_noise;
        }
        all
    }
}

/// The sums of each block. `scale` is that of the loss, in units of the stated noise.
pub fn by_block(
    data: &MovingTriplets<'_>,
    state: &State,
    noise: &Noise,
    loss: Loss,
    scale: Option<f64>,
    blocks: &[Range<usize>],
) -> Vec<Sums> {
    let placed = transforms(state);
    let of_block = |block: &Range<usize>| {
        let mut sums = Sums::zeros();
        // Most errors are of a size where weight and slope are the same, and have one matrix in common.
        let mut excess = Matrix::zeros();
        for index in block.clone() {
            let found = distances(data, index, state, &placed);
            for pair in 0..3 {
                let stated = noise.weights[index][pair];
                let residual = found.residuals.residual_m[pair];
                let size = residual.abs() * stated.sqrt();
                let Influence { weight, slope } = influence(loss, size, scale);
                let (weight, slope) = (stated * weight, stated * slope);
                let derivative = &found.derivative[pair];
                add_square(sums.hessian.as_mut_slice(), derivative.as_slice(), slope);
                if weight != slope {
                    add_square(excess.as_mut_slice(), derivative.as_slice(), weight - slope);
                }
                sums.gradient.axpy(weight * residual, derivative, 1.0);
                let covariance_m2 = &noise.covariance_m2[index][pair];
                found.add_noise_pull(pair, covariance_m2, slope, &mut sums.by_noise);
            }
        }
        sums.hessian.fill_upper_triangle_with_lower_triangle();
        excess.fill_upper_triangle_with_lower_triangle();
        sums.normal = sums.hessian + excess;
        sums.gradient -= sums.by_noise;
        sums
    };
    blocks.iter().map(of_block).collect()
}

/// Numbers of a column that are worked on at once.
const LANES: usize = 4;

/// Adds w J Jᵀ on and below the diagonal. A pair moves with half of the unknowns: the other columns need no work.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
fn add_square(matrix: &mut [f64], derivative: &[f64], weight: f64) {
    let (rows, _) = derivative.as_chunks::<LANES>();
    for (place, column) in matrix.chunks_exact_mut(UNKNOWNS).enumerate() {
        let factor = weight * derivative[place];
        if factor == 0.0 {
            continue;
        }
        let (column, _) = column.as_chunks_mut::<LANES>();
        for k in place / LANES..UNKNOWNS / LANES {
            for l in 0..LANES {
                column[k][l] += factor * rows[k][l];
            }
        }
    }
}

/// What an error of this size counts.
fn influence(loss: Loss, size: f64, scale: Option<f64>) -> Influence {
    match (loss, scale) {
        (Loss::Huber, Some(bend)) => robust::huber(size, bend),
        (Loss::Cauchy, Some(scale)) => robust::cauchy(size, scale),
        _ => robust::SQUARED,
    }
}

/// λ of the refinement's documentation; `None` when the transforms are not held by the data. What the answer follows of
/// each block is missing in it: the prior is for weighing, and its weight need not be exact for σ to be
/// ([`crate::statistics::sandwich`]).
pub fn prior_weight(all: &Sums, blocks: &[Sums]) -> Option<f64> {
    let hessian = all.hessian.fixed_view::<8, 8>(0, 0).into_owned();
    let inverse = hessian.cholesky()?.inverse();
    let of_block = |block: &Sums| {
        let gradient = block.gradient.fixed_rows::<8>(0);
        gradient.dot(&(inverse * gradient))
    };
    Some((blocks.iter().map(of_block).sum::<f64>() / 8.0).max(f64::MIN_POSITIVE))
}

/// The step of the estimated unknowns, zero for the held ones; `None` where the matrix has no minimum.
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
