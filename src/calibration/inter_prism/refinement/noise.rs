//! How noisy each distance of each triplet is, and from what size on an error is doubted.

use nalgebra::Matrix3;

use super::INSTRUMENT;
use super::model::{MovingTriplets, State, distances, transforms};
use crate::calibration::Loss;
use crate::deployment::PAIRS;
use crate::geometry::RigidTransform;
use crate::pipeline::Triplets;

/// What straight lines between readings miss on bends (m, 1 σ); a Gaussian process states its own.
const CHORD_SIGMA_M: f64 = 0.001;
/// Share of two readings' noise that a point between them has on average: ∫(1−s)² + s² ds.
const CHORD_NOISE: f64 = 2.0 / 3.0;
/// Scale of the losses over the residuals' spread: Huber's constant. At it Huber's loss is 95 % and Cauchy's about 80 %
/// efficient on normal errors, and tails as heavy as a real drive's hardly count.
const LOSS_SCALE: f64 = 1.345;

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
            let found = distances(data, index, state, &placed);
            for (pair, covariance_m2) in covariances.iter().enumerate() {
                let stated_m = found.variance_along_m2(pair, covariance_m2).sqrt();
                ratios.push(found.residual_m[pair].abs() / stated_m.max(1e-9));
            }
        }
        let middle = ratios.len() / 2;
        let median = *ratios.select_nth_unstable_by(middle, f64::total_cmp).1;
        let share = (median / 0.6745).powi(2).min(1.0);
        self.covariance_m2.iter_mut().flatten().for_each(|covariance| *covariance *= share);
        self
    }

    /// From the instruments' noise and the interpolation's.
    pub fn new(triplets: &Triplets, station1_from_station: &[RigidTransform; 3]) -> Self {
        let point = |station: usize, index: usize| {
            let turn = station1_from_station[station].rotation.matrix();
            let own = match &triplets.sigma_m {
                // A Gaussian process has weighed the readings already.
                Some(sigma) => Matrix3::from_diagonal(&sigma[station][index].map(|s| s * s)),
                None => INSTRUMENT.covariance_m2(&triplets.points_m[station][index]) * CHORD_NOISE,
            };
            turn * own * turn.transpose()
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

/// The scale of the loss, in units of the stated noise, from the median of the errors' sizes.
pub fn loss_scale(
    data: &MovingTriplets<'_>,
    state: &State,
    noise: &Noise,
    loss: Loss,
) -> Option<f64> {
    if loss == Loss::Squared {
        return None;
    }
    let placed = transforms(state);
    let mut sizes: Vec<f64> = (0..data.triplets.len())
        .flat_map(|index| {
            let residual_m = distances(data, index, state, &placed).residual_m;
            [0, 1, 2].map(|pair| residual_m[pair].abs() * noise.weights[index][pair].sqrt())
        })
        .collect();
    let middle = sizes.len() / 2;
    let median = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
    // Half of normal deviates are smaller than 0.6745.
    Some(LOSS_SCALE * median / 0.6745)
}
