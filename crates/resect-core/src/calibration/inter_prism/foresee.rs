//! Prediction of the observability of a drive, from simulated triplets.

use nalgebra::SMatrix;

use super::levenberg_marquardt::ROUGH_M;
use super::minima::{SAME_TWIN_M, THINNED};
use super::observability::{Observability, observe};
use super::{CentredTriplets, FEWEST_TRIPLETS, Minimum, NormalEquations, minimise, uncertainty};
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
/// `covariance` is the predicted covariance of (x, y, z, yaw) of stations 2 and 3 (m, rad), `None` if it is not available.
pub fn foresee(
    triplets: &Triplets,
    inter_prism_m: &[f64; 3],
    station1_from_station: &PerStation<LevelTransform>,
    covariance: Option<SMatrix<f64, 8, 8>>,
) -> Option<Foreseen> {
    if triplets.len() < FEWEST_TRIPLETS {
        return None;
    }
    let data = CentredTriplets::new(triplets, *inter_prism_m);
    let parameters = data.parameters(station1_from_station.as_slice());
    let normal = NormalEquations::at(&data, &parameters);
    let answer = Minimum { parameters, normal, converged: true, passes: 1 };
    let uncertainty = uncertainty::foreseen(&data, &answer, covariance);
    let thinned = data.thinned(THINNED);
    let mean_square_m2 =
        |minimum: &NormalEquations, of: &CentredTriplets| minimum.cost / (3 * of.len()) as f64;
    let mirrored = data.mirrored_in_height(&parameters, [true, true]);
    let twin = minimise(&thinned, mirrored, ROUGH_M);
    let is_other = (twin.parameters - parameters).amax() > SAME_TWIN_M;
    let twin_mean_square_m2 = is_other.then(|| mean_square_m2(&twin.normal, &thinned));
    Some(Foreseen {
        observability: observe(&data, &parameters, &uncertainty),
        is_held: uncertainty.covariance.is_some(),
        mean_square_m2: mean_square_m2(&answer.normal, &data),
        twin_mean_square_m2,
    })
}
