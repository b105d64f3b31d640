//! What the triplets say about the unknowns at a state: sums over each block of time, and steps out of them.

use std::borrow::Borrow;
use std::ops::Range;

use multiversion::multiversion;

use super::model::{Linearised, Matrix, State, UNKNOWNS, reduced, reduced_vector};
use super::noise::Noise;
use crate::calibration::Loss;
use crate::statistics::robust;
use crate::statistics::robust::Influence;

/// Sums over the triplets of a block of time.
pub struct Block {
    /// Σ ψ'(r) J Jᵀ, on and below the diagonal.
    pub hessian: Matrix,
    /// Σ ψ(r) J, less what noise alone makes of it.
    pub gradient: State,
}

/// Sums over the triplets of each block and of all.
pub struct Sums {
    pub blocks: Vec<Block>,
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
    /// The sums out of each triplet at the state. `scale` is that of the loss, in units of the stated noise.
    pub fn over<T: Borrow<Linearised>>(
        blocks: &[Range<usize>],
        at_state: impl Fn(usize) -> T,
        noise: &Noise,
        loss: Loss,
        scale: Option<f64>,
    ) -> Self {
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
            for index in range.clone() {
                let found = at_state(index);
                let Linearised { residual_m, derivative, noise_pull } = found.borrow();
                for pair in 0..3 {
                    let stated = noise.weights[index][pair];
                    let size = residual_m[pair].abs() * stated.sqrt();
                    let Influence { weight, slope } = influence(loss, size, scale);
                    let (weight, slope) = (stated * weight, stated * slope);
                    let derivative = &derivative[pair];
                    add_square(block.hessian.as_mut_slice(), derivative.as_slice(), slope);
                    // Most errors are of a size where weight and slope are the same.
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
        let first = place / LANES;
        for (into, row) in column[first..].iter_mut().zip(&rows[first..]) {
            for (into, row) in into.iter_mut().zip(row) {
                *into += factor * row;
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
pub fn prior_weight(sums: &Sums) -> Option<f64> {
    let hessian = sums.hessian.fixed_view::<8, 8>(0, 0).into_owned();
    let inverse = hessian.cholesky()?.inverse();
    let of_block = |block: &Block| {
        let gradient = block.gradient.fixed_rows::<8>(0);
        gradient.dot(&(inverse * gradient))
    };
    Some((sums.blocks.iter().map(of_block).sum::<f64>() / 8.0).max(f64::MIN_POSITIVE))
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
