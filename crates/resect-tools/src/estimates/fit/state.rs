//! Unknowns of the fit: their steps, priors and standard deviations.

use nalgebra::{DMatrix, DVector, Rotation3, UnitQuaternion, Vector3};

use super::fit::{Fit, LEAST_GAIN, LEVER_SIGMA_M};
use super::unknowns::{BODY, CLOCK, SCALE};
use resect_core::calibration::Estimate;

/// Number of quantities that wander: rotation of the frame (rad), which begins at 0, its translation (m), errors of position (m) and
/// orientation (rad) that last for some time, and the clock (s), fast and slowly.
pub const WANDERING: usize = 14;
pub const BY_TRANSLATION: usize = 3;
pub const BY_POSITION: usize = 6;
pub const BY_ORIENTATION: usize = 9;
pub const BY_CLOCK: usize = 12;
pub const BY_SLOW_CLOCK: usize = 13;
/// Prior standard deviation of the logarithm of the scale of an estimate that is in metres.
/// Effect: without it, an error of scale counts as one of the lever arm. Field: odometry by wheels or lidar is within a few percent.
const SCALE_SIGMA: f64 = 0.03;

/// State of the iteration: the fit, and the change of the time offset since the ground truth was computed (s).
#[derive(Clone)]
pub struct FitState {
    pub fit: Fit,
    pub later_s: f64,
    /// Prior of the time offset (s), for a ground truth of few points.
    pub offset_prior: Option<Estimate>,
    /// True if the scale is aligned, and so has no prior.
    pub is_scaled: bool,
    /// Rotation of the frame by all epochs together. A frame that the filter follows tilts by noise, which would count as a tilt of the body.
    pub aligned: Rotation3<f64>,
    /// Share of the estimate in the variance of the residuals; the rest is noise that the ground truth states.
    pub share_of_estimate: f64,
    /// True if the lever arm is turned by the estimate's orientations, and not by those of the ground truth.
    pub is_turned_by_estimate: bool,
    /// Share of the trajectory that is not interpolated in the velocities by which the clock is estimated.
    pub share_of_stamped: f64,
    /// Centre of scale (m, in the estimate's frame). Map coordinates are millions of metres from their origin.
    pub pivot_m: Vector3<f64>,
}

impl FitState {
    /// Difference of an unknown from its prior mean; 0 without a prior.
    fn value(&self, unknown: usize) -> f64 {
        match unknown {
            0..CLOCK => self.fit.lever_arm_m.unwrap_or_default()[unknown],
            CLOCK => self.offset_prior.map_or(0.0, |prior| self.fit.time_offset_s - prior.value),
            SCALE if !self.is_scaled => self.fit.scale.ln(),
            _ => 0.0,
        }
    }

    /// Differences of the unknowns from their prior means.
    pub fn values(&self, open: &[usize]) -> DVector<f64> {
        DVector::from_iterator(open.len(), open.iter().map(|unknown| self.value(*unknown)))
    }

    /// Prior precisions 1/σ² of the unknowns.
    pub fn prior_precision(&self, open: &[usize]) -> DVector<f64> {
        let precision = |unknown: &usize| match *unknown {
            0..CLOCK => LEVER_SIGMA_M.powi(-2),
            CLOCK => self.offset_prior.map_or(0.0, |prior| prior.sigma.powi(-2)),
            SCALE if !self.is_scaled => SCALE_SIGMA.powi(-2),
            _ => 0.0,
        };
        DVector::from_iterator(open.len(), open.iter().map(precision))
    }

    /// Applies a step.
    pub fn step(&mut self, open: &[usize], step: &DVector<f64>) {
        let mut turn = Vector3::zeros();
        for (unknown, by) in open.iter().zip(step.iter()) {
            match *unknown {
                0..CLOCK => {
                    if let Some(lever_m) = &mut self.fit.lever_arm_m {
                        lever_m[*unknown] += by;
                    }
                }
                CLOCK => {
                    self.fit.time_offset_s += by;
                    self.later_s += by;
                }
                BODY..SCALE => turn[unknown - BODY] = *by,
                _ => self.fit.scale *= by.exp(),
            }
        }
        if let Some(body) = &mut self.fit.body_rotation {
            *body = UnitQuaternion::from_scaled_axis(turn) * *body;
        }
    }

    /// Stores the standard deviations of clock, lever arm, body rotation and scale.
    pub fn take_sigmas(&mut self, open: &[usize], covariance: &DMatrix<f64>) {
        let sigma = |unknown: usize| {
            let index = open.iter().position(|other| *other == unknown)?;
            Some(covariance[(index, index)].max(0.0).sqrt())
        };
        let vector =
            |first: usize| Some(Vector3::new(sigma(first)?, sigma(first + 1)?, sigma(first + 2)?));
        self.fit.time_offset_sigma_s = sigma(CLOCK);
        self.fit.determines_time_offset = self.offset_prior.is_none_or(|prior| {
            sigma(CLOCK).is_none_or(|sigma_s| sigma_s < LEAST_GAIN * prior.sigma)
        });
        self.fit.lever_arm_sigma_m = vector(0);
        let fitted: Vec<usize> = (0..open.len()).filter(|index| open[*index] < SCALE).collect();
        for &row in &fitted {
            for &column in &fitted {
                self.fit.covariance[(open[row], open[column])] = covariance[(row, column)];
            }
        }
        self.fit.body_rotation_sigma_rad = vector(BODY);
        // Relative: the unknown is the logarithm.
        self.fit.estimated_scale = sigma(SCALE)
            .map(|sigma| Estimate { value: self.fit.scale, sigma: sigma * self.fit.scale });
    }
}
