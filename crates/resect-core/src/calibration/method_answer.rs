//! Answer of one method, before it becomes a [`Calibration`](super::Calibration).

use nalgebra::SMatrix;

use super::judgement::Judgement;
use super::{Method, TransformSigma, Witness};
use crate::geometry::RigidTransform;

/// Answer of one method, with details of its own.
pub struct MethodAnswer<D> {
    pub method: Method,
    pub station1_from_station: [RigidTransform; 3],
    /// Covariance of (x, y, z, yaw) of station 2, then of station 3 (m, rad); `None` where a direction is not determined.
    pub covariance: Option<SMatrix<f64, 8, 8>>,
    pub judgement: Judgement,
    /// Independent data that agrees with the answer.
    pub checked_by: Vec<Witness>,
    pub details: D,
    /// Wall time of the prior (ms).
    pub prior_ms: f64,
}

impl<D> MethodAnswer<D> {
    /// Returns the standard deviations of the transforms of stations 2 and 3.
    pub fn sigma(&self) -> Option<[TransformSigma; 2]> {
        self.covariance.as_ref().map(TransformSigma::of_covariance)
    }
}
