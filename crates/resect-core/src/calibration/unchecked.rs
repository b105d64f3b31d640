//! The common tail of the methods: from transforms and a judgement to a calibration.

use std::time::Instant;

use nalgebra::{SMatrix, Vector3};

use super::judgement::Judgement;
use super::{Calibration, Details, Method, TransformSigma, checks};
use crate::deployment::Deployment;
use crate::geometry::RigidTransform;
use crate::pipeline::Triplets;

/// An answer that is judged by the data of its own method alone.
pub struct UncheckedAnswer {
    pub method: Method,
    pub station1_from_station: [RigidTransform; 3],
    /// Covariance of (x, y, z, yaw) of station 2, then of station 3 (m, rad); `None` where a direction is not determined.
    pub covariance: Option<SMatrix<f64, 8, 8>>,
    pub judgement: Judgement,
    pub details: Details,
}

impl UncheckedAnswer {
    /// Returns the calibration, with the wall time since `started`.
    pub fn into_calibration(self, started: Instant, prior_ms: f64) -> Calibration {
        Calibration {
            method: self.method,
            station1_from_station: self.station1_from_station,
            sigma: self.covariance.as_ref().map(sigmas),
            covariance: self.covariance,
            verdict: self.judgement.verdict,
            findings: self.judgement.findings,
            checked_by: Vec::new(),
            details: self.details,
            published: None,
            prior_ms,
            solve_ms: started.elapsed().as_secs_f64() * 1e3 - prior_ms,
        }
    }

    /// Compares an answer of method A, B or C with the control points and distances that it does not use.
    pub fn checked(
        self,
        deployment: &Deployment,
        triplets: &Triplets,
        started: Instant,
    ) -> Calibration {
        let mut calibration = self.into_calibration(started, 0.0);
        checks::hold_against_the_rest(&mut calibration, deployment, triplets);
        calibration.solve_ms = started.elapsed().as_secs_f64() * 1e3;
        calibration
    }
}

/// Standard deviations of the transforms of stations 2 and 3.
pub fn sigmas(covariance: &SMatrix<f64, 8, 8>) -> [TransformSigma; 2] {
    let sigma = |k: usize| covariance[(k, k)].max(0.0).sqrt();
    [0, 4].map(|k| TransformSigma {
        translation_m: Vector3::new(sigma(k), sigma(k + 1), sigma(k + 2)),
        yaw_rad: sigma(k + 3),
    })
}
