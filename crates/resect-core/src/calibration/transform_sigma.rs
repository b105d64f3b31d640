//! Standard deviations of a transform.

use nalgebra::{SMatrix, Vector3};

/// Standard deviation of each parameter of a transform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransformSigma {
    pub translation_m: Vector3<f64>,
    pub yaw_rad: f64,
}

impl TransformSigma {
    /// Returns the standard deviations of stations 2 and 3 from the covariance of (x, y, z, yaw) of both (m, rad).
    pub fn of_covariance(covariance: &SMatrix<f64, 8, 8>) -> [Self; 2] {
        let sigma = |k: usize| covariance[(k, k)].max(0.0).sqrt();
        [0, 4].map(|k| Self {
            translation_m: Vector3::new(sigma(k), sigma(k + 1), sigma(k + 2)),
            yaw_rad: sigma(k + 3),
        })
    }
}
