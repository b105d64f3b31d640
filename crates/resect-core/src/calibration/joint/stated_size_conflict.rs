//! Tests of error sizes that the user reduced below those of instruments in the field.
//!
//! A size of zero states that there is no such error. The estimate cannot find it then, and [`super::prior_conflict`] cannot see it,
//! because the prior does not let it move. So the equations are solved once more with the usual sizes, and the result is compared
//! with what was stated (a score test: Rao 1948).

use nalgebra::DMatrix;

use super::chain_factor::ChainFactor;
use super::constants_prior::precisions;
use super::gauss_newton_step::GaussNewtonStep;
use super::prior_conflict::LEAST_INFORMATION;
use super::priors::Priors;
use super::state_vector::{Constants, ConstantsMatrix, StateVector};
use super::unknown::{DISTANCE, Unknown};
use crate::calibration::{ErrorSizes, Estimate};

/// An error that the data shows to be larger than stated.
#[derive(Clone, Copy, Debug)]
pub struct StatedSizeConflict {
    pub unknown: &'static Unknown,
    pub owner: usize,
    /// The error by the data alone.
    pub estimate: Estimate,
    /// Distance of the error from zero, in σ of the data and the stated size.
    pub sigmas: f64,
}

impl GaussNewtonStep {
    /// Tests all sizes below the usual ones, as far as the data determines the error.
    pub fn stated_size_conflicts(
        &self,
        priors: &Priors,
        state: &StateVector,
    ) -> Vec<StatedSizeConflict> {
        let layout = &priors.layout;
        let usual = precisions(layout, &ErrorSizes::default());
        let looser = priors.precision.zip_map(&usual, f64::min);
        if looser == priors.precision {
            return Vec::new();
        }
        let is_looser = |index: &usize| looser[*index] < priors.precision[*index];
        let distances = match layout.indices(&DISTANCE).next().filter(is_looser) {
            Some(first) => {
                DMatrix::from_diagonal_element(layout.pairs(), layout.pairs(), looser[first])
            }
            None => priors.distances.clone(),
        };
        let loose = Priors { precision: looser.clone(), distances, ..priors.clone() };
        let right = self.normal.gradient_with_priors(&loose, &self.slow_precisions, state);
        let information = loose.information();
        let solution =
            ChainFactor::new(&self.normal.matrix, &information, &self.slow_precisions, &right);
        let Some((factor, step)) = solution else { return Vec::new() };
        let change = &state.constants - step.constants - &priors.mean;
        let covariance = factor.constants_covariance();
        let stated = &priors.precision;
        let conflict = |(unknown, owner, index)| {
            let (estimate, sigmas) = conflict(index, &change, &covariance, &looser, stated)?;
            Some(StatedSizeConflict { unknown, owner, estimate, sigmas })
        };
        let tested = layout.each().filter(|(.., index)| is_looser(index));
        tested.filter_map(conflict).collect()
    }
}

/// Compares one constant with its stated size: its estimate by the data alone, and its distance from zero (σ). `change` from the prior mean and `covariance` are by the looser prior.
fn conflict(
    index: usize,
    change: &Constants,
    covariance: &ConstantsMatrix,
    looser: &Constants,
    stated: &Constants,
) -> Option<(Estimate, f64)> {
    let by_data = 1.0 - covariance[(index, index)] * looser[index];
    if by_data < LEAST_INFORMATION {
        return None;
    }
    // Without that prior.
    let value = change[index] / by_data;
    let variance = covariance[(index, index)] / by_data;
    let sigmas = value / (variance + stated[index].recip()).sqrt();
    Some((Estimate { value, sigma: variance.sqrt() }, sigmas))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A usual prior of variance 4 and a reading of 10 with variance 4, with a stated variance of 5.
    #[test]
    fn a_stated_size_is_compared_with_the_data_alone() {
        let constants = |value: f64| Constants::from_vec(vec![0.0, value]);
        let covariance = ConstantsMatrix::from_diagonal(&constants(2.0));
        let (looser, stated) = (constants(0.25), constants(0.2));
        let (estimate, sigmas) =
            conflict(1, &constants(5.0), &covariance, &looser, &stated).expect("observed");
        assert!((estimate.value - 10.0).abs() < 1e-12);
        assert!((estimate.sigma - 2.0).abs() < 1e-12);
        assert!((sigmas - 10.0 / 3.0).abs() < 1e-12);
    }
}
