//! The state of the Gauss–Newton iteration: unknowns, their steps and their standard deviations.

use nalgebra::{DMatrix, DVector, Rotation3, Vector3};

use super::fit::{Fit, LEAST_GAIN, LEVER_SIGMA_M};
use resect_core::calibration::Estimate;

/// Number of unknowns.
pub const UNKNOWNS: usize = 11;
/// First index of each kind of unknown; rotation begins at 0.
pub const TRANSLATION: usize = 3;
pub const SCALE: usize = 6;
pub const LEVER: usize = 7;
pub const CLOCK: usize = 10;

/// State of the iteration: the fit, and the change of the time offset since the ground truth was computed (s).
pub struct FitState {
    pub fit: Fit,
    pub later_s: f64,
    /// Prior of the time offset (s), for a ground truth of few points.
    pub offset_prior: Option<Estimate>,
    /// Centre of rotation and scale (m, in the estimate's frame). Map coordinates are millions of metres from their origin.
    pub pivot_m: Vector3<f64>,
}

impl FitState {
    /// Difference of an unknown from its prior mean; 0 without a prior.
    pub fn value(&self, unknown: usize) -> f64 {
        match unknown {
            LEVER..CLOCK => self.fit.lever_arm_m.unwrap_or_default()[unknown - LEVER],
            CLOCK => self.offset_prior.map_or(0.0, |prior| self.fit.time_offset_s - prior.value),
            _ => 0.0,
        }
    }

    /// Prior precisions 1/σ² of the unknowns.
    pub fn prior_precision(&self, open: &[usize]) -> DVector<f64> {
        let precision = |unknown: &usize| match *unknown {
            LEVER..CLOCK => LEVER_SIGMA_M.powi(-2),
            CLOCK => self.offset_prior.map_or(0.0, |prior| prior.sigma.powi(-2)),
            _ => 0.0,
        };
        DVector::from_iterator(open.len(), open.iter().map(precision))
    }

    /// Applies a step, and returns its size in metres or seconds.
    pub fn step(&mut self, open: &[usize], step: &DVector<f64>) -> f64 {
        let mut turn = Vector3::zeros();
        let pivot_m = self.fit.truth_from_estimate.apply(&(self.fit.scale * self.pivot_m));
        let mut moved_m = Vector3::zeros();
        let mut change: f64 = 0.0;
        for (k, by) in open.iter().zip(step.iter()) {
            match *k {
                0..TRANSLATION => turn[*k] = *by,
                TRANSLATION..SCALE => {
                    moved_m[k - TRANSLATION] += by;
                }
                SCALE => self.fit.scale *= by.exp(),
                LEVER..CLOCK => {
                    if let Some(lever_m) = &mut self.fit.lever_arm_m {
                        lever_m[k - LEVER] += by;
                    }
                    change = change.max(by.abs());
                }
                _ => {
                    self.fit.time_offset_s += by;
                    self.later_s += by;
                    change = change.max(by.abs());
                }
            }
        }
        let transform = &mut self.fit.truth_from_estimate;
        transform.rotation = Rotation3::new(turn) * transform.rotation;
        let now_m = transform.rotate(&(self.fit.scale * self.pivot_m));
        transform.translation_m = pivot_m + moved_m - now_m;
        change
    }

    pub fn take_sigmas(&mut self, open: &[usize], covariance: &DMatrix<f64>) {
        let sigma = |unknown: usize| {
            let at = open.iter().position(|k| *k == unknown)?;
            Some(covariance[(at, at)].max(0.0).sqrt())
        };
        self.fit.time_offset_sigma_s = sigma(CLOCK);
        self.fit.determines_time_offset = self.offset_prior.is_none_or(|prior| {
            sigma(CLOCK).is_none_or(|sigma_s| sigma_s < LEAST_GAIN * prior.sigma)
        });
        let lever = [0, 1, 2].map(|axis| sigma(LEVER + axis));
        if let [Some(x), Some(y), Some(z)] = lever {
            self.fit.lever_arm_sigma_m = Some(Vector3::new(x, y, z));
        }
    }
}
