//! What can be wrong with instruments and rig beyond noise: nothing, unless a scenario asks for it.

use nalgebra::{Rotation3, Vector3};

/// Errors that no reading shows by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SystematicErrors {
    /// By how much each station's stamps are late (s).
    pub clock_offset_s: [f64; 3],
    /// How fast each station's stamps fall behind (s per s).
    pub clock_drift: [f64; 3],
    /// A station (1 to 3) whose stamps jump in the middle of the drive, and by how much (s).
    pub clock_step: Option<(usize, f64)>,
    /// How far each station leans about its own x and y (rad).
    pub tilt_rad: [[f64; 2]; 3],
    /// Added to the distances 12, 13, 23 that are written (m).
    pub inter_prism_m: [f64; 3],
    /// Added to every range beside the prism constant (m).
    pub prism_constant_m: f64,
}

impl SystematicErrors {
    /// What is stamped on a reading at a time (s) of a drive of some length.
    pub fn stamp_s(&self, station: usize, time_s: f64, duration_s: f64) -> f64 {
        let step_s = match self.clock_step {
            Some((stepping, step_s)) if stepping == station + 1 && time_s > 0.5 * duration_s => {
                step_s
            }
            _ => 0.0,
        };
        time_s + self.clock_offset_s[station] + self.clock_drift[station] * time_s + step_s
    }

    /// A point of a level station's frame as the leaning station sees it (m).
    pub fn lean(&self, station: usize, point_m: &Vector3<f64>) -> Vector3<f64> {
        let [x, y] = self.tilt_rad[station];
        // The station leans, so the world leans the other way.
        Rotation3::new(Vector3::new(x, y, 0.0)).inverse() * point_m
    }
}
