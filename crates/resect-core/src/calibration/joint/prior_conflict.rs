//! Conflict of the data with the priors of the constants.
//!
//! If the priors are right, an estimate with prior variance P⁻¹ and posterior variance C is normal about its prior mean with the
//! variance P⁻¹ − C. It must not be compared with P⁻¹, which an estimate that the data hardly determines never reaches, nor with C. The
//! same holds for several constants together (Evans & Moshonov 2006, "Checking for prior-data conflict").

use nalgebra::{DMatrix, DVector};

use super::state_vector::{Constants, ConstantsMatrix, Layout};
use super::unknown::{DISTANCE, Effect, Owner};
use crate::network::PerStation;

/// Critical distance of one constant from its prior (σ). Textbook: one of thirty exceeds it by chance once in a thousand drives.
pub const CRITICAL_SIGMAS: f64 = 4.2;
/// Directions whose prior variance the data reduces by less than this share are not tested.
pub const LEAST_INFORMATION: f64 = 0.05;

/// Distances of the constants from their priors, in standard deviations √(P⁻¹ − C).
#[derive(Clone, Debug, PartialEq)]
pub struct PriorConflict {
    /// Change from the prior means, in the constants' own units.
    pub change: Constants,
    /// By constant (σ); zero without a prior, or without information.
    pub sigmas: Constants,
    /// Distances of each station's instrument as a whole, and of all instruments and distances together (σ).
    pub station_sigmas: PerStation<f64>,
    pub all_sigmas: f64,
    /// Distance of the inter-prism distances as a whole (σ).
    pub distances_sigmas: f64,
}

impl PriorConflict {
    /// `change` is from the prior means, `prior` their covariance with zeros for constants without a prior, `covariance` the
    /// posterior one.
    pub fn new(
        layout: &Layout,
        change: &Constants,
        prior: &ConstantsMatrix,
        covariance: &ConstantsMatrix,
    ) -> Self {
        let precision = prior.diagonal().map(|p| if p > 0.0 { p.recip() } else { 0.0 });
        let root = precision.map(f64::sqrt);
        // In units of the priors: the covariance P⁻¹ − C of `scaled`, if they are right.
        let scaled = change.component_mul(&root);
        let expected = ConstantsMatrix::from_fn(layout.constants, layout.constants, |i, j| {
            (prior[(i, j)] - covariance[(i, j)]) * root[i] * root[j]
        });
        let sigmas = Constants::from_fn(layout.constants, |k, _| {
            let is_tested = precision[k] > 0.0 && expected[(k, k)] > LEAST_INFORMATION;
            if is_tested { scaled[k] / expected[(k, k)].sqrt() } else { 0.0 }
        });
        let joint = |indices: &[usize]| {
            let size = indices.len();
            let expected = DMatrix::from_fn(size, size, |i, j| expected[(indices[i], indices[j])]);
            joint_sigmas(expected, &DVector::from_fn(size, |i, _| scaled[indices[i]]))
        };
        let of_instrument = |station| {
            let own = layout.of_instrument(station);
            joint(&own.map(|(_, index)| index).collect::<Vec<usize>>())
        };
        // Latencies are of the clocks, which other tests judge.
        let all = layout.each().filter(|(unknown, ..)| {
            matches!(unknown.owner, Owner::Station | Owner::Pair)
                && !matches!(unknown.effect, Effect::Latency)
        });
        let distances: Vec<usize> = layout.indices(&DISTANCE).collect();
        Self {
            change: change.clone(),
            sigmas,
            station_sigmas: PerStation::from_fn(layout.stations(), of_instrument),
            all_sigmas: joint(&all.map(|(.., index)| index).collect::<Vec<usize>>()),
            distances_sigmas: joint(&distances),
        }
    }
}

/// Returns the quantile of a normal distribution with the probability of the χ² of several numbers (Wilson & Hilferty 1931).
fn joint_sigmas(covariance: DMatrix<f64>, numbers: &DVector<f64>) -> f64 {
    // nalgebra does not decompose an empty matrix.
    if numbers.is_empty() {
        return 0.0;
    }
    let eigen = covariance.symmetric_eigen();
    let (mut chi_square, mut freedom) = (0.0, 0.0);
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > LEAST_INFORMATION {
            chi_square += vector.dot(numbers).powi(2) / value;
            freedom += 1.0;
        }
    }
    if freedom == 0.0 {
        return 0.0;
    }
    let spread: f64 = 2.0 / (9.0 * freedom);
    ((chi_square / freedom).cbrt() - (1.0 - spread)) / spread.sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::state_vector::tests::layout;
    use super::super::unknown::{RANGE_OFFSET, VERTICAL_INDEX};
    use super::*;

    /// A prior of variance 4 and a reading of variance 4 that is off by 10: the estimate moves half way.
    #[test]
    fn a_conflict_is_measured_by_what_the_data_can_change() {
        let layout = layout(3);
        let index = layout.index(&VERTICAL_INDEX, 0);
        let mut prior = ConstantsMatrix::zeros(layout.constants, layout.constants);
        let (mut covariance, mut change) = (prior.clone(), Constants::zeros(layout.constants));
        prior[(index, index)] = 4.0;
        covariance[(index, index)] = 2.0;
        change[index] = 5.0;
        let conflict = PriorConflict::new(&layout, &change, &prior, &covariance);
        // The variances of reading and prior are 8 together.
        assert!((conflict.sigmas[index] - 10.0 / 8.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(conflict.sigmas[layout.index(&RANGE_OFFSET, 0)], 0.0);
    }

    #[test]
    fn a_chi_square_has_the_sigmas_of_a_normal_number() {
        // The 99.865 % quantile of χ² with 9 degrees of freedom is 27.1: 3 σ.
        let numbers = DVector::from_element(9, (27.093_f64 / 9.0).sqrt());
        let sigmas = joint_sigmas(DMatrix::identity(9, 9), &numbers);
        assert!((sigmas - 3.0).abs() < 0.03, "{sigmas}");
    }
}
