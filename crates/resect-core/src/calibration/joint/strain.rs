//! How far the data pulls the constants from what was known of them beforehand.
//!
//! Where priors are right, an estimate x with prior variance P and variance C with the data is normal about its prior with
//! the variance P − C: it must not be held against P, which an estimate never reaches that the data hardly moves, nor
//! against C. The same goes for several together (prior-data conflict: Evans & Moshonov 2006, "Checking for prior-data
//! conflict").

use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use super::unknowns::{
    COLLIMATIONS, CONSTANTS, Constants, DISTANCES, INDICES, LATENCIES, LEANS, OFFSETS, SCALES,
};

/// Directions of which the data tells less than this share tell nothing of a conflict.
pub const LEAST_TOLD: f64 = 0.05;

/// How far constants are from their priors, in σ of what priors that are right would give.
#[derive(Clone, Debug, PartialEq)]
pub struct Strain {
    /// How far the constants are from the priors, in their own units.
    pub moved: Constants,
    /// Strain of each constant (σ); zero where nothing was known or the data tells nothing.
    pub of: Constants,
    /// Strain of each station's instrument as a whole, and of all instruments and distances (σ).
    pub of_stations: [f64; 3],
    pub of_all: f64,
    /// Strain of the three distances as a whole (σ).
    pub of_distances: f64,
}

impl Strain {
    /// `moved` is from the priors, `precision` theirs, `covariance` what is left with the data.
    pub fn new(
        moved: &Constants,
        precision: &Constants,
        covariance: &SMatrix<f64, CONSTANTS, CONSTANTS>,
    ) -> Self {
        let root = precision.map(f64::sqrt);
        // In units of the priors: where they are right, these have the covariance `told`.
        let (raw, moved) = (*moved, moved.component_mul(&root));
        let told = SMatrix::<f64, CONSTANTS, CONSTANTS>::from_fn(|i, j| {
            f64::from(u8::from(i == j)) - covariance[(i, j)] * root[i] * root[j]
        });
        let of = SVector::from_fn(|k, _| {
            let is_told = precision[k] > 0.0 && told[(k, k)] > LEAST_TOLD;
            if is_told { moved[k] / told[(k, k)].sqrt() } else { 0.0 }
        });
        let together = |places: &[usize]| {
            let told =
                DMatrix::from_fn(places.len(), places.len(), |i, j| told[(places[i], places[j])]);
            let moved = DVector::from_fn(places.len(), |i, _| moved[places[i]]);
            together(told, &moved)
        };
        let of_station = |station: usize| {
            let lean = LEANS + 2 * station;
            let single = [LATENCIES, OFFSETS, SCALES, INDICES, COLLIMATIONS];
            let mut places = vec![lean, lean + 1];
            places.extend(single.map(|first| first + station));
            together(&places)
        };
        let all: Vec<usize> = (DISTANCES..CONSTANTS).collect();
        Self {
            moved: raw,
            of,
            of_stations: [0, 1, 2].map(of_station),
            of_all: together(&all),
            of_distances: together(&all[..3]),
        }
    }
}

/// σ of a normal distribution beyond which chance is as rare as beyond the χ² of several numbers with a covariance
/// (Wilson & Hilferty 1931).
fn together(covariance: DMatrix<f64>, numbers: &DVector<f64>) -> f64 {
    let eigen = covariance.symmetric_eigen();
    let (mut chi_square, mut freedom) = (0.0, 0.0);
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > LEAST_TOLD {
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
    use super::*;

    /// A prior of variance 4 and a reading of variance 4 that is off by 10: the estimate moves half way.
    #[test]
    fn an_estimate_is_held_against_what_the_data_can_move_it() {
        let mut precision = Constants::zeros();
        precision[INDICES] = 0.25;
        let mut covariance = SMatrix::zeros();
        covariance[(INDICES, INDICES)] = 2.0;
        let mut moved = Constants::zeros();
        moved[INDICES] = 5.0;
        let strain = Strain::new(&moved, &precision, &covariance);
        // The reading's own variance and the prior's are 8 together.
        assert!((strain.of[INDICES] - 10.0 / 8.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(strain.of[OFFSETS], 0.0);
    }

    #[test]
    fn a_sum_of_squares_is_as_rare_as_a_normal_number() {
        // The 99.865 % quantile of χ² with 9 degrees of freedom is 27.1: 3 σ.
        let numbers = DVector::from_element(9, (27.093_f64 / 9.0).sqrt());
        let sigmas = together(DMatrix::identity(9, 9), &numbers);
        assert!((sigmas - 3.0).abs() < 0.03, "{sigmas}");
    }
}
