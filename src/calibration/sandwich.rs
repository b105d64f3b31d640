//! The covariance of an estimate from data that is correlated in time, by blocks of time that are not.
//!
//! With the information H = Σ H_b of the blocks and the gradient g_b of each at the minimum, the covariance is
//! H⁻¹ (Σ g_b g_bᵀ) H⁻¹ (Liang & Zeger 1986). The gradients at a minimum are smaller than those of the errors, because
//! the estimate follows each block by its leverage A_b = L⁻¹ H_b L⁻ᵀ, H = L Lᵀ: were the blocks' errors as the information
//! says, Σ E[g_b g_bᵀ] would be made of A_b (I − A_b), and not of A_b. So each gradient is multiplied by
//! (I − A_b)^(−1/2), which makes that exact (Bell & McCaffrey 2002, "Bias reduction in standard errors for linear
//! regression with multi-stage samples": CR2). A common factor B / (B − 1) is right only where each block tells about
//! every unknown alike; a bend tells about some, and with eight unknowns and 16 blocks it leaves variances a sixth too small
//! in the tests below, and more where blocks differ more.

use nalgebra::{DMatrix, DVector};

/// A block that alone holds a direction says nothing about the error along it: leverages end here.
const MOST_LEVERAGE: f64 = 0.9;
/// Leverages whose sum is below this need no eigenvalues: the series ends after its third term, good to a thousandth.
const SMALL_LEVERAGE: f64 = 0.1;

/// What one block of time says: its part of the information, and of the gradient at the minimum.
pub struct Block {
    pub information: DMatrix<f64>,
    pub gradient: DVector<f64>,
}

/// The covariance; `None` where the information leaves a direction free.
pub fn covariance(
    information: &DMatrix<f64>,
    blocks: impl Iterator<Item = Block>,
) -> Option<DMatrix<f64>> {
    let lower = information.clone().cholesky()?.unpack();
    let inverse = lower.solve_lower_triangular(&DMatrix::identity(lower.nrows(), lower.ncols()))?;
    let mut middle = DMatrix::zeros(lower.nrows(), lower.ncols());
    for block in blocks {
        let leverage = &inverse * block.information * inverse.transpose();
        let gradient = unfollowed(leverage, &inverse * block.gradient);
        middle.ger(1.0, &gradient, &gradient, 1.0);
    }
    let covariance = inverse.transpose() * middle * inverse;
    covariance.iter().all(|entry| entry.is_finite()).then_some(covariance)
}

/// (I − A)^(−1/2) g.
fn unfollowed(leverage: DMatrix<f64>, gradient: DVector<f64>) -> DVector<f64> {
    if leverage.trace() < SMALL_LEVERAGE {
        let once = &leverage * &gradient;
        let twice = &leverage * &once;
        return gradient + 0.5 * once + 0.375 * twice;
    }
    let spectrum = leverage.symmetric_eigen();
    let mut parts = spectrum.eigenvectors.tr_mul(&gradient);
    for (part, leverage) in parts.iter_mut().zip(&spectrum.eigenvalues) {
        *part /= (1.0 - leverage.clamp(0.0, MOST_LEVERAGE)).sqrt();
    }
    spectrum.eigenvectors * parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    const UNKNOWNS: usize = 8;
    const ROWS: usize = 12;

    /// Rows of a block about a direction of its own, as the chords of one bend are.
    fn design(blocks: usize, rng: &mut ChaCha8Rng) -> Vec<DMatrix<f64>> {
        (0..blocks)
            .map(|_| {
                let about: Vec<f64> = (0..UNKNOWNS).map(|_| rng.random_range(-1.0..1.0)).collect();
                DMatrix::from_fn(ROWS, UNKNOWNS, |_, k| about[k] + rng.random_range(-0.7..0.7))
            })
            .collect()
    }

    /// Mean over the unknowns of stated over true variance, the truth from many draws of the errors, of which each block
    /// has so much in common.
    fn stated_over_true(blocks: usize, adjusted: bool, shared: f64) -> f64 {
        let mut rng = ChaCha8Rng::seed_from_u64(blocks as u64);
        let (mut stated, mut truth) =
            (DMatrix::zeros(UNKNOWNS, UNKNOWNS), DMatrix::zeros(UNKNOWNS, UNKNOWNS));
        let mut ratios = Vec::new();
        for _ in 0..8 {
            let design = design(blocks, &mut rng);
            let information: DMatrix<f64> = design.iter().map(|x| x.transpose() * x).sum();
            let inverse = information.clone().cholesky().expect("full rank").inverse();
            stated.fill(0.0);
            truth.fill(0.0);
            for _ in 0..150 {
                let errors: Vec<DVector<f64>> = (0..blocks)
                    .map(|_| {
                        let common = shared * rng.random_range(-1.0..1.0);
                        DVector::from_fn(ROWS, |_, _| common + rng.random_range(-1.0..1.0))
                    })
                    .collect();
                let pull: DVector<f64> = design.iter().zip(&errors).map(|(x, e)| x.tr_mul(e)).sum();
                let off = &inverse * pull;
                truth.ger(1.0, &off, &off, 1.0);
                let parts = design.iter().zip(&errors).map(|(x, e)| {
                    let information = x.transpose() * x;
                    let gradient = x.tr_mul(&(e - x * &off));
                    Block { information, gradient }
                });
                if adjusted {
                    stated += covariance(&information, parts).expect("held");
                } else {
                    let middle: DMatrix<f64> =
                        parts.map(|block| &block.gradient * block.gradient.transpose()).sum();
                    let few = blocks as f64 / (blocks as f64 - 1.0);
                    stated += &inverse * middle * &inverse * few;
                }
            }
            ratios.extend((0..UNKNOWNS).map(|k| stated[(k, k)] / truth[(k, k)]));
        }
        ratios.iter().sum::<f64>() / ratios.len() as f64
    }

    #[test]
    fn stated_variances_are_the_true_ones_from_8_to_60_blocks() {
        for blocks in [8, 12, 16, 20, 60] {
            let ratio = stated_over_true(blocks, true, 0.0);
            assert!((0.93..1.07).contains(&ratio), "{blocks} blocks: {ratio:.3}");
            // Of errors that a block shares, which the information does not know of, a little is missing while blocks are few.
            let ratio = stated_over_true(blocks, true, 0.7);
            assert!(blocks < 16 || (0.85..1.07).contains(&ratio), "{blocks} blocks: {ratio:.3}");
        }
    }

    #[test]
    fn a_common_factor_leaves_them_too_small() {
        let ratio = stated_over_true(16, false, 0.0);
        assert!(ratio < 0.88, "{ratio:.3}");
    }

    #[test]
    fn the_series_and_the_eigenvalues_agree() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let rows = DMatrix::<f64>::from_fn(4, UNKNOWNS, |_, _| rng.random_range(-1.0..1.0));
        let leverage = rows.transpose() * &rows;
        let leverage = &leverage * (0.099 / leverage.trace());
        let gradient = DVector::from_fn(UNKNOWNS, |_, _| rng.random_range(-1.0..1.0));
        let by_series = unfollowed(leverage.clone(), gradient.clone());
        let root = (DMatrix::identity(UNKNOWNS, UNKNOWNS) - leverage).symmetric_eigen();
        let by_root = &root.eigenvectors
            * DMatrix::from_diagonal(&root.eigenvalues.map(|value| value.powf(-0.5)))
            * root.eigenvectors.transpose()
            * gradient;
        assert!((by_series - by_root).norm() < 1e-3);
    }
}
