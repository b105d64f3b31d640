//! How noisy each distance of each triplet is, and from what size on an error is doubted.

use nalgebra::Matrix3;

use super::INSTRUMENT;
use super::model::{State, residuals, transforms};
use crate::calibration::Loss;
use crate::calibration::MovingTriplets;
use crate::deployment::PAIRS;
use crate::geometry::RigidTransform;
use crate::pipeline::Triplets;
use crate::statistics::robust::{CAUCHY_SCALE, HUBER_BEND};
use crate::statistics::sigma_of_errors;

/// What straight lines between readings miss on bends (m, 1 σ); a Gaussian process states its own.
const CHORD_SIGMA_M: f64 = 0.001;
/// Share of two readings' noise that a point between them has on average: ∫(1−s)² + s² ds.
const CHORD_NOISE: f64 = 2.0 / 3.0;
/// Errors of a simulation without any are this at least, in units of the stated noise.
const LEAST_SIGMA: f64 = 1e-12;

/// What is known of the noise of each triplet and pair.
pub struct Noise {
    /// 1/σ² of the distance (1/m²), all alike.
    pub weights: Vec<[f64; 3]>,
    /// Covariance of the separation, in station 1's frame (m²).
    pub covariance_m2: Vec<[Matrix3<f64>; 3]>,
}

impl Noise {
    /// No larger than the residuals show: what is stated may be too much for a good day, and for a Gaussian process. Not
    /// larger than stated either: residuals hold more than noise.
    pub fn no_larger_than_residuals(mut self, data: &MovingTriplets<'_>, state: &State) -> Self {
        let placed = transforms(state);
        let mut ratios = Vec::with_capacity(3 * self.covariance_m2.len());
        for (index, covariances) in self.covariance_m2.iter().enumerate() {
            let found = residuals(data, index, state, &placed);
            for (pair, covariance_m2) in covariances.iter().enumerate() {
                let stated_m = found.variance_along_m2(pair, covariance_m2).sqrt();
                ratios.push(found.residual_m[pair] / stated_m.max(1e-9));
            }
        }
        let share = sigma_of_errors(ratios).unwrap_or(1.0).powi(2).min(1.0);
        self.covariance_m2.iter_mut().flatten().for_each(|covariance| *covariance *= share);
        self
    }

    /// Noise that the instruments and the interpolation make.
    pub fn new(triplets: &Triplets, station1_from_station: &[RigidTransform; 3]) -> Self {
        let point = |station: usize, index: usize| {
            let to_station1 = &station1_from_station[station];
            match &triplets.sigma_m {
                // A Gaussian process has weighed the readings already.
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
        let covariance_m2: Vec<[Matrix3<f64>; 3]> = (0..triplets.len())
            .map(|index| {
                let points = [0, 1, 2].map(|station| point(station, index));
                PAIRS.map(|(a, b)| points[a] + points[b])
            })
            .collect();
        // The size does not matter: λ and the loss take their scale from the residuals.
        let weights = vec![[CHORD_SIGMA_M.powi(-2); 3]; triplets.len()];
        Self { weights, covariance_m2 }
    }
}

/// The scale of the loss, in units of the stated noise, from the σ of each triplet's errors (m).
pub fn loss_scale(
    residuals_m: impl Iterator<Item = [f64; 3]>,
    noise: &Noise,
    loss: Loss,
) -> Option<f64> {
    let scale = match loss {
        Loss::Squared => return None,
        Loss::Huber => HUBER_BEND,
        Loss::Cauchy => CAUCHY_SCALE,
    };
    let errors = residuals_m.zip(&noise.weights).flat_map(|(residual_m, weights)| {
        [0, 1, 2].map(|pair| residual_m[pair] * weights[pair].sqrt())
    });
    Some(scale * sigma_of_errors(errors)?.max(LEAST_SIGMA))
}
