//! Standard deviations of a transform.

use nalgebra::{Dim, Matrix, RawStorage, Vector3};

use crate::network::PerStation;

/// Standard deviation of each parameter of a transform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransformSigma {
    pub translation_m: Vector3<f64>,
    pub yaw_rad: f64,
}

impl TransformSigma {
    /// The standard deviations of the reference, station 1.
    pub const ZERO: Self = Self { translation_m: Vector3::new(0.0, 0.0, 0.0), yaw_rad: 0.0 };

    /// Returns the standard deviations of each station from the covariance of (x, y, z, yaw) of station 2, then of station 3, …
    /// (m, rad).
    pub fn of_covariance<D: Dim>(
        covariance: &Matrix<f64, D, D, impl RawStorage<f64, D, D>>,
    ) -> PerStation<Self> {
        let sigma = |k: usize| covariance[(k, k)].max(0.0).sqrt();
        let others = (0..covariance.nrows()).step_by(4).map(|k| Self {
            translation_m: Vector3::new(sigma(k), sigma(k + 1), sigma(k + 2)),
            yaw_rad: sigma(k + 3),
        });
        std::iter::once(Self::ZERO).chain(others).collect()
    }
}
