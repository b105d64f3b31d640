//! Noise of the distances of each triplet, and the bend of Huber's loss.

use nalgebra::Matrix3;

use super::model::{ClockCheckModel, LinearisedTriplets, PolarNoise, State, residuals};
use crate::calibration::MovingTriplets;
use crate::calibration::inter_prism::PrismNetwork;
use crate::geometry::{ARCSECOND_RAD, RigidTransform};
use crate::network::{PerStation, Station};
use crate::pipeline::Triplets;
use crate::statistics::robust::HUBER_BEND;
use crate::statistics::sigma_of_errors;

/// Noise of the Trimble S7: 2 mm + 2 ppm, one arcsecond. Source: Vaidis et al. 2022, section "Experiments".
const INSTRUMENT: PolarNoise =
    PolarNoise { range_m: 0.002, range_share: 2e-6, angle_rad: ARCSECOND_RAD };
/// Interpolation error of straight lines between readings on bends (m, 1 σ); a Gaussian process states its own.
const CHORD_SIGMA_M: f64 = 0.001;
/// Weight of a distance residual (1/m²). The value does not matter: the weight of the priors and the loss scale with the
/// residuals.
pub const WEIGHT_PER_M2: f64 = 1.0 / (CHORD_SIGMA_M * CHORD_SIGMA_M);
/// Mean share of two readings' noise variance in a point between them. Textbook: ∫(1−s)² + s² ds.
const CHORD_NOISE: f64 = 2.0 / 3.0;
/// Smallest σ of the residuals, in units of the stated noise; a simulation without noise reaches zero.
const LEAST_SIGMA: f64 = 1e-12;

/// Covariances of the separations of each triplet's pairs, in station 1's frame (m²).
pub struct SeparationCovariances {
    pub covariance_m2: Vec<Vec<Matrix3<f64>>>,
}

impl SeparationCovariances {
    /// Scales the noise down if the stated noise is larger than the residuals.
    ///
    /// Stated noise may be too large for a good day, and for a Gaussian process. Residuals contain more than noise, so it is never
    /// scaled up.
    pub fn no_larger_than_residuals(
        mut self,
        model: &ClockCheckModel,
        data: &MovingTriplets<'_>,
        state: &State,
    ) -> Self {
        let placed = model.transforms(state);
        let mut ratios = Vec::with_capacity(model.residuals.len() * self.covariance_m2.len());
        for (index, covariances) in self.covariance_m2.iter().enumerate() {
            let found = residuals(model, data, index, state, &placed);
            for (observed, residual) in model.residuals.iter().zip(found) {
                let stated_m = residual.variance_along_m2(&covariances[observed.pair]).sqrt();
                ratios.push(residual.residual_m / stated_m.max(1e-9));
            }
        }
        let share = sigma_of_errors(ratios).unwrap_or(1.0).powi(2).min(1.0);
        self.covariance_m2.iter_mut().flatten().for_each(|covariance| *covariance *= share);
        self
    }

    /// Computes the noise of the instruments and of the interpolation.
    pub fn new(
        network: &PrismNetwork,
        triplets: &Triplets,
        station1_from_station: &PerStation<RigidTransform>,
    ) -> Self {
        let point = |station: Station, index: usize| {
            let to_station1 = &station1_from_station[station];
            match &triplets.sigma_m {
                // A Gaussian process has weighted the readings already.
                Some(sigma) => {
                    let turn = to_station1.rotation.matrix();
                    let own = Matrix3::from_diagonal(&sigma[station][index].map(|s| s * s));
                    turn * own * turn.transpose()
                }
                None => {
                    let sight_m = to_station1.rotate(&triplets.points_m[station][index]);
                    INSTRUMENT.covariance_m2(&sight_m) * CHORD_NOISE
                }
            }
        };
        let covariance_m2 = (0..triplets.len())
            .map(|index| {
                let points = station1_from_station.map_each(|station, _| point(station, index));
                let pairs = network.pairs.iter().map(|pair| pair.stations);
                pairs.map(|pair| points[pair.first] + points[pair.second]).collect()
            })
            .collect();
        Self { covariance_m2 }
    }
}

/// Returns the bend of Huber's loss in units of the stated noise, from the σ of the residuals; infinite without residuals.
pub fn huber_bend(linearised: &LinearisedTriplets) -> f64 {
    let weight = WEIGHT_PER_M2.sqrt();
    let errors = linearised.residual_m.iter().map(|m| m * weight);
    sigma_of_errors(errors).map_or(f64::INFINITY, |sigma| HUBER_BEND * sigma.max(LEAST_SIGMA))
}
