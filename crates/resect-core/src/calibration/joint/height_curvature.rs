//! Covariance of the heights by the curvature of the cost.
//!
//! The distances of the rig determine heights by the tilts of the vehicle, which have noise. The Gauss–Newton normal matrix N counts the noise
//! of the tilts as information, the Hessian H of the cost does not (errors in variables: Fuller 1987). On flat ground most of the information
//! on heights may be noise, if the distances are not measured. The covariance is `H⁻¹` (Laplace's approximation).
//!
//! H is known by gradients of states nearby, for the directions `P = N⁻¹ Jᵀ` of the heights with the Jacobian J. With `C = J N⁻¹ Jᵀ = L Lᵀ`
//! and the eigenvectors U and eigenvalues Λ of `L⁻¹ Pᵀ H P L⁻ᵀ`, a change δ with the covariance `N⁻¹` has the covariance `H⁻¹` in the span of P
//! if it becomes
//!
//! ```text
//! δ + P G J δ,  G = L⁻ᵀ U (Λ^(−1/2) − 1) Uᵀ L⁻¹                                                 (27)
//! ```
//!
//! Λ is the share of the information that is not noise. The response `N⁻¹ g` to a further gradient g, such as that of the facets, is `H⁻¹ g` in truth:
//! with `Λ⁻¹` instead of its root.

use nalgebra::{DMatrix, DVector};

use super::chain::ChainVector;
use super::gauss_newton_step::GaussNewtonStep;
use super::gradients::gradients;
use super::linearisation::Linearisation;
use super::motion_band::MotionBand;
use super::priors::Priors;
use super::random_walks::SlowPrecisions;
use super::state_vector::{BlockVector, StateVector};
use crate::progress::{Cancelled, Progress};

/// Shift of a state for the gradients nearby (σ).
const SHIFT_SIGMAS: f64 = 0.3;
/// Least share of the information on a height that is not noise: σ grows by a factor of three at most.
const LEAST_SHARE: f64 = 0.1;

/// G of (27), that of the response to a gradient, and the least share Λ.
pub struct HeightCurvature {
    pub by_heights: DMatrix<f64>,
    pub of_response: DMatrix<f64>,
    pub least_share: f64,
}

impl HeightCurvature {
    /// Covariance of heights beyond that by the normal matrix.
    pub fn more(&self, covariance: &DMatrix<f64>) -> DMatrix<f64> {
        let size = covariance.nrows();
        let factor = DMatrix::identity(size, size) + covariance * &self.by_heights;
        &factor * covariance * factor.transpose() - covariance
    }

    /// That of a cost without curvature.
    pub fn none(size: usize) -> Self {
        let zeros = DMatrix::zeros(size, size);
        Self { by_heights: zeros.clone(), of_response: zeros, least_share: 1.0 }
    }
}

/// Returns the curvature at the state of a step, with these priors; `directions` are P, and `heights` is the product of J and a vector.
pub fn height_curvature(
    step: &GaussNewtonStep,
    state: &StateVector,
    priors: (&Priors, &SlowPrecisions),
    directions: &[ChainVector],
    heights: &dyn Fn(&ChainVector) -> DVector<f64>,
    progress: &Progress,
) -> Result<HeightCurvature, Cancelled> {
    let size = directions.len();
    let of_directions: Vec<DVector<f64>> = directions.iter().map(heights).collect();
    let covariance = DMatrix::from_fn(size, size, |row, column| of_directions[column][row]);
    let shift = |index: usize| SHIFT_SIGMAS / covariance[(index, index)].sqrt();
    let mut products = Vec::with_capacity(size);
    for (index, direction) in directions.iter().enumerate() {
        let change = change_of_gradient(step, state, priors, &direction.scaled(shift(index)));
        progress.check()?;
        let Some(change) = change else { return Ok(HeightCurvature::none(size)) };
        products.push(change.scaled(shift(index).recip()));
    }
    let hessian = DMatrix::from_fn(size, size, |row, column| {
        0.5 * (directions[row].dot(&products[column]) + directions[column].dot(&products[row]))
    });
    Ok(curvature(covariance, &hessian))
}

/// Returns the curvature, with limits of the shares; none where the Hessian is not determined.
fn curvature(covariance: DMatrix<f64>, hessian: &DMatrix<f64>) -> HeightCurvature {
    let none = HeightCurvature::none(covariance.nrows());
    let Some(root) = covariance.cholesky().map(|factor| factor.l()) else { return none };
    let Some(inverse) = root.try_inverse() else { return none };
    if hessian.iter().any(|value| !value.is_finite()) {
        return none;
    }
    let shares = (&inverse * hessian * inverse.transpose()).symmetric_eigen();
    let axes = inverse.tr_mul(&shares.eigenvectors);
    let more = |power: f64| {
        let more = shares.eigenvalues.map(|share| share.clamp(LEAST_SHARE, 1.0).powf(-power) - 1.0);
        &axes * DMatrix::from_diagonal(&more) * axes.transpose()
    };
    HeightCurvature {
        by_heights: more(0.5),
        of_response: more(1.0),
        least_share: shares.eigenvalues.min(),
    }
}

/// Returns the change of the gradient if the state moves by a vector, and the motion follows; `None` if rows cannot be recomputed.
fn change_of_gradient(
    step: &GaussNewtonStep,
    state: &StateVector,
    (priors, slow_precisions): (&Priors, &SlowPrecisions),
    shift: &ChainVector,
) -> Option<ChainVector> {
    let jacobians = &step.normal.matrix.jacobians;
    // Before and behind.
    let moved = [-0.5, 0.5].map(|share| (share, shifted(state, shift, share)));
    let linearisations =
        moved.each_ref().map(|(share, state)| (*share, Linearisation::new(state, jacobians)));
    let of_segment = |index: usize, band: &MotionBand| -> Vec<BlockVector> {
        let mut change: Vec<BlockVector> = Vec::new();
        for (share, linearisation) in &linearisations {
            let block_step = |block: usize| -> BlockVector {
                let (by_constants, by_slow) = jacobians.of_block(block);
                // (19). Steps are subtracted.
                -*share * (by_constants * &shift.constants + by_slow * &shift.slow[block])
            };
            let block_steps: Vec<BlockVector> =
                linearisation.blocks(index).map(block_step).collect();
            let own_m = state.coefficients_m[index].iter();
            let moved_m: Vec<f64> =
                own_m.zip(band.motion_step(&block_steps)).map(|(own, step)| own - step).collect();
            let (segment, point) = linearisation.segment_with(index, &moved_m);
            let mut sums = gradients(segment, &point, &step.levels, &step.segments[index].weights);
            band.eliminate_from(&mut [(&mut sums.knots[..], &mut sums.blocks[..])]);
            if change.is_empty() {
                change = sums.blocks.into_iter().map(|before| -before).collect();
            } else {
                change.iter_mut().zip(&sums.blocks).for_each(|(sum, after)| *sum += after);
            }
        }
        change
    };
    let of_segments = step.map_segments(state, 0..step.segments.len(), of_segment);
    let of_segments: Vec<Vec<BlockVector>> = of_segments.into_iter().collect::<Option<_>>()?;
    let mut change = step.normal.matrix.gradient(of_segments.into_iter().flatten());
    change.constants += priors.information() * &shift.constants;
    for (block, slow) in change.slow.iter_mut().enumerate() {
        *slow += slow_precisions.multiply(&shift.slow, block);
    }
    Some(change)
}

/// A state without a motion, whose constants and slow states have moved by a share of a vector.
fn shifted(state: &StateVector, shift: &ChainVector, share: f64) -> StateVector {
    let (constants, mut slow) = (&state.constants + share * &shift.constants, state.slow.clone());
    slow.iter_mut().zip(&shift.slow).for_each(|(slow, shift)| slow.axpy(share, shift, 1.0));
    StateVector { constants, slow, coefficients_m: Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn information_that_is_half_noise_gives_twice_the_variance_and_response_and_limits_hold() {
        let covariance = DMatrix::from_row_slice(2, 2, &[4.0, 1.0, 1.0, 9.0]);
        let scaled = |more: DMatrix<f64>| {
            let factor = DMatrix::identity(2, 2) + &covariance * more;
            (&factor * &covariance * factor.transpose()).diagonal()
        };
        let of_share = |share: f64| curvature(covariance.clone(), &(&covariance * share));
        let variances = |share: f64| scaled(of_share(share).by_heights);
        for (share, times) in [(0.5, 2.0), (1.0, 1.0), (1.7, 1.0), (0.01, 10.0), (-3.0, 10.0)] {
            let expected = covariance.diagonal() * times;
            assert!((variances(share) - &expected).norm() < 1e-9, "{share}");
            // A response to a gradient is twice as large.
            let expected = covariance.diagonal() * (times * times);
            assert!((scaled(of_share(share).of_response) - &expected).norm() < 1e-9, "{share}");
        }
        assert_eq!(variances(f64::NAN), covariance.diagonal());
    }
}
