//! The covariance of an estimate from data that is correlated in time, by blocks of time that are not.
//!
//! With the information H = Σ H_b of the blocks and the gradient g_b of each at the minimum, the covariance is
//! H⁻¹ (Σ g_b g_bᵀ) H⁻¹ (Liang & Zeger 1986). The gradients at a minimum are smaller than those of the errors, because
//! the estimate follows each block by its leverage A_b = L⁻¹ H_b L⁻ᵀ, H = L Lᵀ: were the blocks' errors as the information
//! says, Σ E[g_b g_bᵀ] would be made of A_b (I − A_b), and not of A_b. So each gradient is multiplied by
//! (I − A_b)^(−1/2), which makes that exact (Bell & McCaffrey 2002, "Bias reduction in standard errors for linear
//! regression with multi-stage samples": CR2). A common factor, such as B / (B − 1) of B blocks or B / (B − n) of n
//! unknowns, is right only where each block tells about every unknown alike; a bend tells about some.
//!
//! With prior knowledge of precision P that counts with weight w in the cost, the minimum has A = H + wP in the place of H,
//! and the prior pulls at it by its own error, of covariance P⁻¹: the covariance is A⁻¹ (Σ g_b g_bᵀ + w²P) A⁻¹. With
//! blocks whose errors are φ times what their information says this is A⁻¹ (φH + w²P) A⁻¹, and not (H/φ + P)⁻¹ unless
//! w = φ. The estimate follows the blocks less the more the prior holds it: A_b = L⁻¹ H_b L⁻ᵀ with A = L Lᵀ. Then
//! E[g_b g_bᵀ] = φ (H_b − H_b A⁻¹ H_b) as before if w = φ; with another w the difference is below φ H_b / 4B.

use nalgebra::{DMatrix, DVector};

/// A block that alone holds a direction says nothing about the error along it: leverages end here.
const MOST_LEVERAGE: f64 = 0.9;
/// Leverages that are together (Frobenius' norm) below this need no eigenvalues: a series gets there sooner.
const SERIES_LEVERAGE: f64 = 0.7;
/// Below this none of them matters much, negative ones included.
const SMALL_LEVERAGE: f64 = 0.1;
/// What is this much smaller is lost in rounding; the series is there after so many terms at most.
const ROUNDING: f64 = 1e-12;
const MOST_TERMS: u32 = 80;

/// What one block of time says: its part of the information, and of the gradient at the minimum.
pub struct Block {
    pub information: DMatrix<f64>,
    pub gradient: DVector<f64>,
}

/// What is known of the unknowns without the data.
pub struct Prior {
    /// 1/σ² of each; zero where nothing is known.
    pub precision: DVector<f64>,
    /// What it counts by in the cost that was minimised, where the information of the data counts once.
    pub weight: f64,
}

/// The covariance; `None` where the information, that of the prior included, leaves a direction free.
pub fn covariance(blocks: &[Block], prior: Option<&Prior>) -> Option<DMatrix<f64>> {
    let unknowns = blocks.first()?.gradient.len();
    let mut information = DMatrix::zeros(unknowns, unknowns);
    let mut by_prior = DMatrix::zeros(unknowns, unknowns);
    blocks.iter().for_each(|block| information += &block.information);
    if let Some(Prior { precision, weight }) = prior {
        information += DMatrix::from_diagonal(&(precision * *weight));
        by_prior += DMatrix::from_diagonal(&(precision * (weight * weight)));
    }
    let lower = information.cholesky()?.unpack();
    let inverse = lower.solve_lower_triangular(&DMatrix::identity(unknowns, unknowns))?;
    let transposed = inverse.transpose();
    let mut middle = &inverse * by_prior * &transposed;
    for block in blocks {
        let leverage = &inverse * &block.information * &transposed;
        let gradient = unfollowed(leverage, &inverse * &block.gradient);
        middle.ger(1.0, &gradient, &gradient, 1.0);
    }
    let covariance = transposed * middle * inverse;
    covariance.iter().all(|entry| entry.is_finite()).then_some(covariance)
}

/// (I − A)^(−1/2) g.
fn unfollowed(leverage: DMatrix<f64>, gradient: DVector<f64>) -> DVector<f64> {
    // A loss that sets errors aside can make a block's information negative along some directions, and the series counts
    // these: they are nothing while they are small, and must not be there otherwise.
    let size = leverage.norm();
    if size < SMALL_LEVERAGE || (size < SERIES_LEVERAGE && has_no_negative(&leverage)) {
        return by_series(&leverage, gradient);
    }
    let spectrum = leverage.symmetric_eigen();
    let mut parts = spectrum.eigenvectors.tr_mul(&gradient);
    for (part, leverage) in parts.iter_mut().zip(&spectrum.eigenvalues) {
        *part /= (1.0 - leverage.clamp(0.0, MOST_LEVERAGE)).sqrt();
    }
    spectrum.eigenvectors * parts
}

/// Whether a matrix is positive semidefinite, but for rounding.
fn has_no_negative(leverage: &DMatrix<f64>) -> bool {
    let mut lifted = leverage.clone();
    for k in 0..lifted.nrows() {
        lifted[(k, k)] += ROUNDING;
    }
    lifted.cholesky().is_some()
}

/// The sum of all c_k Aᵏ g with c_0 = 1 and c_k = c_(k−1) (2k − 1)/2k, until nothing is added any more.
fn by_series(leverage: &DMatrix<f64>, mut term: DVector<f64>) -> DVector<f64> {
    let mut sum = term.clone();
    let mut next = term.clone();
    let negligible = ROUNDING * sum.norm();
    for k in 1..MOST_TERMS {
        let power = f64::from(k);
        next.gemv((2.0 * power - 1.0) / (2.0 * power), leverage, &term, 0.0);
        std::mem::swap(&mut next, &mut term);
        sum += &term;
        if term.norm() <= negligible {
            break;
        }
    }
    sum
}

#[cfg(test)]
mod tests;
