//! Prediction of the observability of a drive, from simulated triplets.

use nalgebra::DMatrix;

use super::levenberg_marquardt::ROUGH_M;
use super::minima::{SAME_TWIN_M, THINNED};
use super::observability::{Observability, observe};
use super::{
    CentredTriplets, FEWEST_TRIPLETS, Minimum, NormalEquations, PrismNetwork, minimise, uncertainty,
};
use crate::geometry::LevelTransform;
use crate::network::PerStation;
use crate::pipeline::Triplets;

/// Predicted observability of a drive.
#[derive(Clone, Debug)]
pub struct Foreseen {
    pub observability: Observability,
    /// True if all directions are observable.
    pub is_held: bool,
    /// Mean squared inter-prism error at the true poses (m²); from interpolation alone if readings have no noise.
    pub mean_square_m2: f64,
    /// Mean squared inter-prism error of the mirror twin (m²); `None` if there is none.
    pub twin_mean_square_m2: Option<f64>,
}

/// Predicts the observability of a drive with stations at known poses; `None` for too few triplets.
///
/// `covariance` is the predicted covariance of (x, y, z, yaw) of station 2, then of each further one (m, rad), `None` if it is not
/// available.
pub fn foresee(
    triplets: &Triplets,
    network: &PrismNetwork,
    station1_from_station: &PerStation<LevelTransform>,
    covariance: Option<DMatrix<f64>>,
) -> Option<Foreseen> {
    if triplets.len() < FEWEST_TRIPLETS {
        return None;
    }
    let data = CentredTriplets::new(triplets, network);
    let parameters = data.parameters(station1_from_station);
    let normal = NormalEquations::at(&data, &parameters);
    let answer = Minimum { parameters: parameters.clone(), normal, converged: true, passes: 1 };
    let uncertainty = uncertainty::foreseen(&data, &answer, covariance);
    let thinned = data.thinned(THINNED);
    let twin = minimise(&thinned, data.mirrored_in_height(&parameters), ROUGH_M);
    let is_other = (&twin.parameters - &parameters).amax() > SAME_TWIN_M;
    let twin_mean_square_m2 = is_other.then(|| thinned.mean_square_m2(twin.normal.cost));
    Some(Foreseen {
        observability: observe(&data, &parameters, &uncertainty),
        is_held: uncertainty.covariance.is_some(),
        mean_square_m2: data.mean_square_m2(answer.normal.cost),
        twin_mean_square_m2,
    })
}
