//! Priors of the unknowns: mean and precision of the constants, random walks of the slow states.

use nalgebra::{Matrix3, Vector3, Vector4};

use super::PAIRS;
use super::constants_prior::precisions;
use super::prior_conflict::LEAST_INFORMATION;
use super::random_walks::{GaussMarkov, SlowPriors};
use super::residuals::{OBSERVED_DISTANCE_SIGMA_M, RIG_FLEX_SIGMA_M};
use super::settling::{own_settling, relative_settling};
use super::state_vector::{CLOCKS, Constants, ConstantsMatrix, DISTANCES, DRIFTS};
use super::survey_change::SurveyEvidence;
use crate::calibration::ErrorSizes;
use crate::deployment::Rig;

/// Standard deviation of a clock offset once the data rejects its prior, and of that of a further drive (s).
const WIDE_CLOCK_S: f64 = 1.0;
/// An offset this far from its prior rejects it (σ).
const REJECTED_SIGMAS: f64 = 4.0;

/// Standard deviation of the prism constant with which the rig was read (m): some files apply it and others do not.
const RIG_CONSTANT_M: f64 = 0.01;
/// Standard deviation of a distance that is no evidence (m).
const UNKNOWN_DISTANCE_M: f64 = 0.1;

/// The inter-prism distances as measured on the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigDistances {
    pub measured_m: [f64; 3],
    /// Jacobian of the distances by the prism constant of the reading; zeros if the reading is not known.
    pub by_prism_constant: [f64; 3],
    /// False if the distances are only where the iteration starts.
    pub are_evidence: bool,
}

impl RigDistances {
    /// The distances of a rig, with the geometry of its reading.
    pub fn new(rig: &Rig, are_evidence: bool) -> Self {
        let by_prism_constant = rig.prisms_m.as_ref().map_or([0.0; 3], |prisms_m| {
            PAIRS.map(|(a, b)| {
                let along = (prisms_m[a] - prisms_m[b]).normalize();
                (prisms_m[a].normalize() - prisms_m[b].normalize()).dot(&along)
            })
        });
        let measured_m = *rig.inter_prism_m.as_array().expect("three prisms");
        Self { measured_m, by_prism_constant, are_evidence }
    }

    /// Distances of a reading without a prism constant.
    pub fn exact(measured_m: &[f64; 3]) -> Self {
        Self { measured_m: *measured_m, by_prism_constant: [0.0; 3], are_evidence: true }
    }

    /// Information about the distances (1/m²); `sigma_m` is the standard deviation of each beside the prism constant.
    fn information(&self, sigma_m: f64) -> Matrix3<f64> {
        let sigma_m = if self.are_evidence { sigma_m.max(1e-6) } else { UNKNOWN_DISTANCE_M };
        let by_constant_m = RIG_CONSTANT_M * Vector3::from(self.by_prism_constant);
        let covariance = Matrix3::from_diagonal_element(sigma_m.powi(2))
            + by_constant_m * by_constant_m.transpose();
        // Positive definite: a positive diagonal plus a square.
        covariance.try_inverse().unwrap_or_else(|| Matrix3::from_diagonal_element(sigma_m.powi(-2)))
    }
}

/// Priors of all unknowns but the motion, and the survey.
#[derive(Clone, Debug)]
pub struct Priors {
    /// Prior mean of the constants.
    pub mean: Constants,
    /// 1/σ² of each constant; zero without a prior. Those of the distances are replaced by [`Self::distances`].
    pub precision: Constants,
    /// Information about the inter-prism distances (1/m²).
    pub distances: Matrix3<f64>,
    /// False if the measured distances are only where the iteration starts.
    pub distances_are_evidence: bool,
    /// Standard deviation of an observed distance of the rig, once a knot (m).
    pub observed_distance_m: f64,
    /// Variances of one station's settling over a drive (x, y, z, yaw; m², rad²).
    pub own_settling: Vector4<f64>,
    pub slow: SlowPriors,
    pub survey: Option<SurveyEvidence>,
}

impl Priors {
    /// The priors at the start of an estimate; `restarts_s` are the starts of further drives (s).
    pub fn new(
        sizes: &ErrorSizes,
        mean: &Constants,
        rig: Option<&RigDistances>,
        restarts_s: &[f64],
    ) -> Self {
        let slow_errors =
            if sizes.ranges_wander { GaussMarkov::SMALLEST } else { GaussMarkov::NONE };
        let slow = SlowPriors {
            settling: relative_settling(sizes, mean),
            clocks_s2: sizes.clock_wander_s.max(1e-7).powi(2),
            ranges: slow_errors,
            across: slow_errors,
            upward: slow_errors,
            restarts_s: restarts_s.to_vec(),
            restarted_s2: WIDE_CLOCK_S.powi(2),
            station_steps: Vec::new(),
            clock_steps: Vec::new(),
        };
        let distances = rig.map_or_else(
            || Matrix3::from_diagonal_element(sizes.inter_prism_m.max(1e-6).powi(-2)),
            |rig| rig.information(sizes.inter_prism_m),
        );
        Self {
            mean: *mean,
            precision: precisions(sizes),
            distances,
            distances_are_evidence: rig.is_none_or(|rig| rig.are_evidence),
            observed_distance_m: if sizes.ranges_wander {
                OBSERVED_DISTANCE_SIGMA_M
            } else {
                RIG_FLEX_SIGMA_M
            },
            own_settling: own_settling(sizes),
            slow,
            survey: None,
        }
    }

    /// Widens the priors of clock offsets that the constants reject, and returns their stations (1 or 2); `covariance` is the posterior
    /// one.
    pub fn widen_clock_offsets(
        &mut self,
        constants: &Constants,
        covariance: &ConstantsMatrix,
    ) -> Vec<usize> {
        let mut widened = Vec::new();
        for index in CLOCKS..DRIFTS {
            let prior_s2 = self.precision[index].recip();
            let moved_s2 = prior_s2 - covariance[(index, index)];
            let change_s = constants[index] - self.mean[index];
            let is_tested = moved_s2 > LEAST_INFORMATION * prior_s2;
            // (22)
            let is_rejected = change_s.powi(2) > REJECTED_SIGMAS.powi(2) * moved_s2;
            let wide_precision = WIDE_CLOCK_S.powi(-2);
            if is_tested && is_rejected && self.precision[index] > wide_precision {
                self.precision[index] = wide_precision;
                widened.push(index - CLOCKS + 1);
            }
        }
        widened
    }

    /// Information of the priors about the constants, without the survey.
    pub fn own_information(&self) -> ConstantsMatrix {
        let mut information = ConstantsMatrix::from_diagonal(&self.precision);
        information.fixed_view_mut::<3, 3>(DISTANCES, DISTANCES).copy_from(&self.distances);
        information
    }

    /// Prior covariance of the constants; zero for those without a prior.
    pub fn covariance(&self) -> ConstantsMatrix {
        let variances =
            self.precision.map(|precision| if precision > 0.0 { precision.recip() } else { 0.0 });
        let mut covariance = ConstantsMatrix::from_diagonal(&variances);
        let distances = self.distances.try_inverse().unwrap_or_else(Matrix3::zeros);
        covariance.fixed_view_mut::<3, 3>(DISTANCES, DISTANCES).copy_from(&distances);
        covariance
    }

    /// Information of priors and survey about the constants.
    pub fn information(&self) -> ConstantsMatrix {
        let survey = self.survey.as_ref().map(|survey| survey.information);
        self.own_information() + survey.unwrap_or_else(ConstantsMatrix::zeros)
    }

    /// Cost of priors and survey (σ²).
    pub fn cost(&self, constants: &Constants) -> f64 {
        let change = constants - self.mean;
        let survey = self.survey.as_ref().map_or(0.0, |survey| survey.cost(constants));
        change.dot(&(self.own_information() * change)) + survey // (14)
    }

    /// Gradient of the costs of priors and survey.
    pub fn gradient(&self, constants: &Constants) -> Constants {
        let survey = self.survey.as_ref().map(|survey| survey.gradient(constants));
        let own = self.own_information() * (constants - self.mean);
        own + survey.unwrap_or_else(Constants::zeros)
    }
}

#[cfg(test)]
mod tests {
    use super::super::random_walks::SlowPrecisions;
    use super::*;

    #[test]
    fn error_sizes_of_zero_give_finite_precisions() {
        let sizes = ErrorSizes {
            clock_wander_s: 0.0,
            clock_offset_s: 0.0,
            settling_m: 0.0,
            settling_rad: 0.0,
            ..ErrorSizes::default()
        };
        let priors = Priors::new(&sizes, &Constants::zeros(), None, &[30.0]);
        let precisions = SlowPrecisions::new(&priors.slow, &[3.0, 9.0, 40.0]).expect("positive");
        for block in 0..3 {
            assert!(precisions.diagonal(block).iter().all(|value| value.is_finite()), "{block}");
        }
    }
}
