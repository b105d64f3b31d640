//! Covariance of an estimate from data that is correlated in time within blocks, and independent between blocks.
//!
//! With the information H = Σ H_b of the blocks and the gradient g_b of each at the minimum, the covariance is H⁻¹ (Σ g_b g_bᵀ) H⁻¹
//! (Liang & Zeger 1986). The gradients at a minimum are smaller than those of the errors, because the estimate follows each block
//! by its leverage A_b = L⁻¹ H_b L⁻ᵀ, H = L Lᵀ. If the blocks' errors had the stated information, Σ E[g_b g_bᵀ] would consist of
//! A_b (I − A_b) instead of A_b. Each gradient is therefore multiplied by (I − A_b)^(−1/2), which makes the expectation exact (CR2:
//! Bell & McCaffrey 2002, "Bias reduction in standard errors for linear regression with multi-stage samples"). A common factor,
//! such as B / (B − 1) of B blocks or B / (B − n) of n unknowns, is right only if all blocks inform about all unknowns equally. A
//! bend informs about some of them.
//!
//! With a prior of precision P and weight w in the cost, the minimum has A = H + wP instead of H. The prior adds its own error, of
//! covariance P⁻¹, so the covariance is A⁻¹ (Σ g_b g_bᵀ + w²P) A⁻¹. With block errors of φ times their stated variance this is A⁻¹
//! (φH + w²P) A⁻¹, and not (H/φ + P)⁻¹ unless w = φ. A strong prior reduces the leverages: A_b = L⁻¹ H_b L⁻ᵀ with A = L Lᵀ. Then
//! E[g_b g_bᵀ] = φ (H_b − H_b A⁻¹ H_b) as before if w = φ; with another w the difference is below φ H_b / 4B.

use nalgebra::{DMatrix, DVector};

/// Upper limit of leverages: a block that alone determines a direction contains no information about its error there.
const MOST_LEVERAGE: f64 = 0.9;
/// Below this Frobenius norm of the leverage, a series is faster than eigenvalues.
const SERIES_LEVERAGE: f64 = 0.7;
/// Below this norm all leverages are negligible, negative ones included.
const SMALL_LEVERAGE: f64 = 0.1;
/// Relative size of rounding errors, and the most terms of the series, which reaches that size earlier.
const ROUNDING: f64 = 1e-12;
const MOST_TERMS: u32 = 80;

/// Information of one block of time, and its gradient at the minimum.
pub struct Block {
    pub information: DMatrix<f64>,
    pub gradient: DVector<f64>,
}

impl Block {
    /// Returns neighbouring blocks as one; they are not empty.
    pub fn sum(blocks: &[Self]) -> Self {
        let mut sum = Self {
            information: blocks[0].information.clone(),
            gradient: blocks[0].gradient.clone(),
        };
        for block in &blocks[1..] {
            sum.information += &block.information;
            sum.gradient += &block.gradient;
        }
        sum
    }
}

/// Prior of the unknowns.
pub struct Prior {
    /// 1/σ² of each unknown; zero without a prior.
    pub precision: DVector<f64>,
    /// Weight of the prior in the minimised cost, where the data has weight 1.
    pub weight: f64,
}

/// Returns the covariance; `None` if the information, with the prior, leaves a direction unobservable.
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

/// Returns (I − A)^(−1/2) g.
fn unfollowed(leverage: DMatrix<f64>, gradient: DVector<f64>) -> DVector<f64> {
    // A redescending loss can make a block's information negative along some directions. The series includes these, which is
    // harmless only while they are small.
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

/// Returns true if a matrix is positive semidefinite, except for rounding.
fn has_no_negative(leverage: &DMatrix<f64>) -> bool {
    let mut lifted = leverage.clone();
    for k in 0..lifted.nrows() {
        lifted[(k, k)] += ROUNDING;
    }
    lifted.cholesky().is_some()
}

/// Returns Σ c_k Aᵏ g with c_0 = 1 and c_k = c_(k−1) (2k − 1)/2k, until terms are negligible.
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
