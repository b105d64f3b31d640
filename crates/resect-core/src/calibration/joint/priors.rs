//! Priors of the unknowns: mean and precision of the constants, random walks of the slow states.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Vector4};

use super::constants_prior::precisions;
use super::prior_conflict::LEAST_INFORMATION;
use super::random_walks::{GaussMarkov, SlowPriors};
use super::residuals::{OBSERVED_DISTANCE_SIGMA_M, RIG_FLEX_SIGMA_M};
use super::settling::{own_settling, relative_settling};
use super::state_vector::{Constants, ConstantsMatrix, Layout};
use super::survey_change::SurveyEvidence;
use super::unknown::{CLOCK_OFFSET, DISTANCE};
use crate::calibration::ErrorSizes;
use crate::deployment::Rig;
use crate::network::{Number, PerPair, Station};

/// Standard deviation of a clock offset once the data rejects its prior, and of that of a further drive (s).
const WIDE_CLOCK_S: f64 = 1.0;
/// An offset this far from its prior rejects it (σ).
const REJECTED_SIGMAS: f64 = 4.0;

/// Standard deviation of the prism constant with which the rig was read (m): some files apply it and others do not.
const RIG_CONSTANT_M: f64 = 0.01;
/// Time for which a distance has the same error by facets (s): so long a vehicle keeps its incidence.
/// Effect: more knots do not show more of the distance. Simulated: with knots that count alone 1, 5 and 12 % of the answers are not good at 2.5, 5 and
/// 10 Hz, with this time 1, 0 and 2 %. With 1 s heights in tunnels are 1.5 times as far off as stated at 10 Hz, with 4 s a real drive fits the distances
/// worse by everything than by the drive (1.11).
const FACET_S: f64 = 1.5;
/// Standard deviation of a distance that is no evidence (m).
const UNKNOWN_DISTANCE_M: f64 = 0.1;

/// The distances between the followed prisms as measured on the vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct RigDistances {
    pub measured_m: PerPair<f64>,
    /// Jacobian of the distances by the prism constant of the reading; zeros if the reading is not known.
    pub by_prism_constant: PerPair<f64>,
    /// False if the distances are only where the iteration starts.
    pub are_evidence: bool,
}

impl RigDistances {
    /// The distances of a rig between the prisms that are followed, with the geometry of its reading.
    pub fn new(rig: &Rig, layout: &Layout, are_evidence: bool) -> Self {
        let pairs = PerPair::from_fn(layout.pairs(), |pair| layout.pair(pair));
        let by_prism_constant = rig.distances_by_prism_constant();
        Self {
            measured_m: pairs.map(|pair| rig.inter_prism_m[*pair]),
            by_prism_constant: pairs.map(|pair| by_prism_constant[*pair]),
            are_evidence,
        }
    }

    /// Distances of a reading without a prism constant.
    pub fn exact(measured_m: PerPair<f64>) -> Self {
        let by_prism_constant = measured_m.map(|_| 0.0);
        Self { measured_m, by_prism_constant, are_evidence: true }
    }

    /// Information about the distances (1/m²); `sigma_m` is the standard deviation of each beside the prism constant.
    fn information(&self, sigma_m: f64) -> DMatrix<f64> {
        let sigma_m = if self.are_evidence { sigma_m.max(1e-6) } else { UNKNOWN_DISTANCE_M };
        let by_constant_m =
            RIG_CONSTANT_M * DVector::from_column_slice(self.by_prism_constant.as_slice());
        let pairs = by_constant_m.len();
        let alone = DMatrix::from_diagonal_element(pairs, pairs, sigma_m.powi(2));
        // Positive definite: a positive diagonal plus a square.
        (alone + &by_constant_m * by_constant_m.transpose())
            .try_inverse()
            .unwrap_or_else(|| DMatrix::from_diagonal_element(pairs, pairs, sigma_m.powi(-2)))
    }
}

/// Priors of all unknowns but the motion, and the survey.
#[derive(Clone, Debug)]
pub struct Priors {
    pub layout: Arc<Layout>,
    /// Prior mean of the constants.
    pub mean: Constants,
    /// 1/σ² of each constant; zero without a prior. Those of the distances are replaced by [`Self::distances`].
    pub precision: Constants,
    /// Information about the inter-prism distances (1/m²).
    pub distances: DMatrix<f64>,
    /// False if the measured distances are only where the iteration starts.
    pub distances_are_evidence: bool,
    /// True if prisms have errors that repeat with the incidence.
    pub has_facets: bool,
    /// Variances of one station's settling over a drive (x, y, z, yaw; m², rad²).
    pub own_settling: Vector4<f64>,
    pub slow: SlowPriors,
    pub survey: Option<SurveyEvidence>,
}

impl Priors {
    /// The priors at the start of an estimate; `restarts_s` are the starts of further drives (s).
    pub fn new(
        layout: &Arc<Layout>,
        sizes: &ErrorSizes,
        mean: &Constants,
        rig: &RigDistances,
        restarts_s: &[f64],
    ) -> Self {
        let slow_errors =
            if sizes.ranges_wander { GaussMarkov::SMALLEST } else { GaussMarkov::NONE };
        let slow = SlowPriors {
            settling: relative_settling(sizes, mean, layout.moved()),
            clocks_s2: sizes.clock_wander_s.max(1e-7).powi(2),
            ranges: slow_errors,
            across: slow_errors,
            upward: slow_errors,
            restarts_s: restarts_s.to_vec(),
            restarted_s2: WIDE_CLOCK_S.powi(2),
            station_steps: Vec::new(),
            clock_steps: Vec::new(),
        };
        Self {
            layout: Arc::clone(layout),
            mean: mean.clone(),
            precision: precisions(layout, sizes),
            distances: rig.information(sizes.inter_prism_m),
            distances_are_evidence: rig.are_evidence,
            has_facets: sizes.ranges_wander,
            own_settling: own_settling(sizes),
            slow,
            survey: None,
        }
    }

    /// Standard deviation of an observed distance of the rig, once a knot; knots are this far apart (m).
    pub fn observed_distance_m(&self, knot_s: f64) -> f64 {
        if !self.has_facets {
            return RIG_FLEX_SIGMA_M;
        }
        OBSERVED_DISTANCE_SIGMA_M / independent_share(knot_s).sqrt()
    }

    /// Widens the priors of clock offsets that the constants reject, and returns their stations; `covariance` is the posterior one.
    pub fn widen_clock_offsets(
        &mut self,
        constants: &Constants,
        covariance: &ConstantsMatrix,
    ) -> Vec<Station> {
        let mut widened = Vec::new();
        for (slot, index) in self.layout.indices(&CLOCK_OFFSET).enumerate() {
            let prior_s2 = self.precision[index].recip();
            let moved_s2 = prior_s2 - covariance[(index, index)];
            let change_s = constants[index] - self.mean[index];
            let is_tested = moved_s2 > LEAST_INFORMATION * prior_s2;
            // (22)
            let is_rejected = change_s.powi(2) > REJECTED_SIGMAS.powi(2) * moved_s2;
            let wide_precision = WIDE_CLOCK_S.powi(-2);
            if is_tested && is_rejected && self.precision[index] > wide_precision {
                self.precision[index] = wide_precision;
                widened.push(Station::at(slot + 1));
            }
        }
        widened
    }

    /// Information of the priors about the constants, without the survey.
    pub fn own_information(&self) -> ConstantsMatrix {
        self.with_distances(&self.precision, &self.distances)
    }

    /// Prior covariance of the constants; zero for those without a prior.
    pub fn covariance(&self) -> ConstantsMatrix {
        let variances =
            self.precision.map(|precision| if precision > 0.0 { precision.recip() } else { 0.0 });
        let pairs = self.layout.pairs();
        let distances = self.distances.clone().try_inverse();
        self.with_distances(&variances, &distances.unwrap_or_else(|| DMatrix::zeros(pairs, pairs)))
    }

    /// Returns a matrix with this diagonal, and with this part of the distances.
    fn with_distances(&self, diagonal: &Constants, distances: &DMatrix<f64>) -> ConstantsMatrix {
        let mut matrix = ConstantsMatrix::from_diagonal(diagonal);
        for (i, row) in self.layout.indices(&DISTANCE).enumerate() {
            for (j, column) in self.layout.indices(&DISTANCE).enumerate() {
                matrix[(row, column)] = distances[(i, j)];
            }
        }
        matrix
    }

    /// Information of priors and survey about the constants.
    pub fn information(&self) -> ConstantsMatrix {
        let own = self.own_information();
        match &self.survey {
            Some(survey) => own + &survey.information,
            None => own,
        }
    }

    /// Cost of priors and survey (σ²).
    pub fn cost(&self, constants: &Constants) -> f64 {
        let change = constants - &self.mean;
        let survey = self.survey.as_ref().map_or(0.0, |survey| survey.cost(constants));
        change.dot(&(self.own_information() * &change)) + survey // (14)
    }

    /// Gradient of the costs of priors and survey.
    pub fn gradient(&self, constants: &Constants) -> Constants {
        let own = self.own_information() * (constants - &self.mean);
        match &self.survey {
            Some(survey) => own + survey.gradient(constants),
            None => own,
        }
    }
}

/// Share of the knots whose distances have independent errors by facets; knots are this far apart.
pub fn independent_share(knot_s: f64) -> f64 {
    (knot_s / FACET_S).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::super::chain_factor::chain_shape;
    use super::super::random_walks::SlowPrecisions;
    use super::super::state_vector::tests::layout;
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
        for stations in 1..5 {
            let layout = layout(stations);
            let none = RigDistances::exact(PerPair::repeat(layout.pairs(), 1.0));
            let mean = Constants::zeros(layout.constants);
            let priors = Priors::new(&layout, &sizes, &mean, &none, &[30.0]);
            let precisions = SlowPrecisions::new(&priors.slow, &layout, &[3.0, 9.0, 40.0]);
            let precisions = precisions.expect("positive");
            let shape = chain_shape(&layout);
            for block in 0..3 {
                let mut row = vec![0.0; shape.numbers()];
                precisions.add_to_row(block, &mut row, shape);
                assert!(row.iter().all(|value| value.is_finite()), "{stations}, {block}");
            }
        }
    }
}
