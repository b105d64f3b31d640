//! The state of the Gauss–Newton iteration: unknowns, their steps and their standard deviations.

use nalgebra::{DMatrix, DVector, Rotation3, Vector3};

use super::fit::Fit;

/// Number of unknowns.
pub const UNKNOWNS: usize = 11;
/// First index of each kind of unknown; rotation begins at 0.
pub const TRANSLATION: usize = 3;
pub const SCALE: usize = 6;
pub const LEVER: usize = 7;
pub const CLOCK: usize = 10;

/// Prior standard deviation of a lever arm (m), of the size of a vehicle. It decides only where the drive does not determine
/// the lever arm, such as its height on level ground.
const LEVER_SIGMA_M: f64 = 1.0;

/// State of the iteration: the fit, and the change of the time offset since the ground truth was computed (s).
pub struct FitState {
    pub fit: Fit,
    pub later_s: f64,
}

impl FitState {
    /// Value of an unknown that has a prior, else 0.
    pub fn value(&self, unknown: usize) -> f64 {
        match unknown {
            LEVER..CLOCK => self.fit.lever_arm_m.unwrap_or_default()[unknown - LEVER],
            _ => 0.0,
        }
    }

    /// Applies a step, and returns its size in metres or seconds.
    pub fn step(&mut self, open: &[usize], step: &DVector<f64>) -> f64 {
        let mut turn = Vector3::zeros();
        let mut change: f64 = 0.0;
        for (k, by) in open.iter().zip(step.iter()) {
            match *k {
                0..TRANSLATION => turn[*k] = *by,
                TRANSLATION..SCALE => {
                    self.fit.station1_from_estimate.translation_m[k - TRANSLATION] += by;
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
        let rotation = &mut self.fit.station1_from_estimate.rotation;
        *rotation = Rotation3::new(turn) * *rotation;
        change
    }

    pub fn take_sigmas(&mut self, open: &[usize], covariance: &DMatrix<f64>) {
        let sigma = |unknown: usize| {
            let at = open.iter().position(|k| *k == unknown)?;
            Some(covariance[(at, at)].max(0.0).sqrt())
        };
        self.fit.time_offset_sigma_s = sigma(CLOCK);
        let lever = [0, 1, 2].map(|axis| sigma(LEVER + axis));
        if let [Some(x), Some(y), Some(z)] = lever {
            self.fit.lever_arm_sigma_m = Some(Vector3::new(x, y, z));
        }
    }
}

/// Prior precisions 1/σ² of the unknowns.
pub fn prior_of(open: &[usize]) -> DVector<f64> {
    let precision = |unknown: &usize| match *unknown {
        LEVER..CLOCK => LEVER_SIGMA_M.powi(-2),
        _ => 0.0,
    };
    DVector::from_iterator(open.len(), open.iter().map(precision))
}
