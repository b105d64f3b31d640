//! Priors of the unknowns: mean and precision of the constants, random walks of the slow states.

use nalgebra::Vector3;

use super::random_walks::{RangeWander, SlowPriors};
use super::settling::relative_settling;
use super::state_vector::{
    CLOCKS, COLLIMATIONS, CONSTANTS, Constants, DISTANCES, DRIFTS, INDICES, LATENCIES, LEANS,
    OFFSETS, SCALES,
};
use super::station_model::EARTH_RADIUS_M;
use crate::calibration::ErrorSizes;
use crate::geometry::LevelTransform;

/// Priors of all unknowns but the motion.
#[derive(Clone, Debug)]
pub struct Priors {
    /// Prior mean of the constants.
    pub mean: Constants,
    /// 1/σ² of each constant; zero without a prior.
    pub precision: Constants,
    pub slow: SlowPriors,
}

impl Priors {
    /// The priors at the start of an estimate; `restarts_s` are the starts of further drives (s).
    pub fn new(sizes: &ErrorSizes, mean: &Constants, restarts_s: &[f64]) -> Self {
        let slow = SlowPriors {
            settling: relative_settling(sizes, mean),
            clocks_s2: sizes.clock_wander_s.max(1e-7).powi(2),
            wander: RangeWander::SMALLEST,
            restarts_s: restarts_s.to_vec(),
            restarted_s2: sizes.clock_offset_s.max(1e-7).powi(2),
            station_steps: Vec::new(),
            clock_steps: Vec::new(),
        };
        Self { mean: *mean, precision: precisions(sizes), slow }
    }

    /// Gradient of the constants' prior.
    pub fn gradient(&self, constants: &Constants) -> Constants {
        self.precision.component_mul(&(constants - self.mean))
    }
}

/// Precisions (1/σ²) of the constants; zero for the transforms, which have no prior.
pub fn precisions(sizes: &ErrorSizes) -> Constants {
    // A size of zero constrains an unknown almost exactly.
    let of = |sigma: f64, least: f64| sigma.max(least).powi(-2);
    let mut precision = Constants::zeros();
    let mut fill = |indices: std::ops::Range<usize>, value: f64| {
        precision.rows_mut(indices.start, indices.len()).fill(value);
    };
    fill(CLOCKS..DRIFTS, of(sizes.clock_offset_s, 1e-7));
    fill(DRIFTS..LATENCIES, of(sizes.clock_drift, 1e-9));
    fill(LATENCIES..DISTANCES, of(sizes.latency_s, 1e-7));
    fill(DISTANCES..LEANS, of(sizes.inter_prism_m, 1e-6));
    fill(LEANS..OFFSETS, of(sizes.lean_rad, 1e-9));
    fill(OFFSETS..SCALES, of(sizes.range_offset_m, 1e-6));
    fill(SCALES..INDICES, of(sizes.range_scale, 1e-8));
    fill(INDICES..COLLIMATIONS, of(sizes.index_rad, 1e-9));
    fill(COLLIMATIONS..CONSTANTS, of(sizes.collimation_rad, 1e-9));
    precision
}

/// Returns the prior mean of the constants: a published answer, the measured distances (m), and leans by the curvature of the earth.
pub fn prior_mean(published: &[LevelTransform; 3], inter_prism_m: Option<&[f64; 3]>) -> Constants {
    let mut constants = Constants::zeros();
    for slot in 0..2 {
        let transform = &published[slot + 1];
        constants.fixed_rows_mut::<3>(4 * slot).copy_from(&transform.translation_m);
        constants[4 * slot + 3] = transform.yaw_rad;
        // The plumb line of a distant station leans away from station 1.
        let away = Vector3::new(transform.translation_m.x, transform.translation_m.y, 0.0);
        let lean = transform.inverse().rotate(&Vector3::z().cross(&away)) / EARTH_RADIUS_M;
        constants.fixed_rows_mut::<2>(LEANS + 2 * (slot + 1)).copy_from(&lean.xy());
    }
    constants.fixed_rows_mut::<3>(DISTANCES).copy_from_slice(inter_prism_m.unwrap_or(&[0.0; 3]));
    constants
}

#[cfg(test)]
mod tests {
    use super::super::random_walks::SlowPrecisions;
    use super::*;

    #[test]
    fn error_sizes_of_zero_give_finite_precisions() {
        let sizes = ErrorSizes {
            clock_wander_s: 0.0,
            clock_offset_s: 0.0,
            settling_m: 0.0,
            settling_rad: 0.0,
            ..ErrorSizes::default()
        };
        let priors = Priors::new(&sizes, &Constants::zeros(), &[30.0]);
        let precisions = SlowPrecisions::new(&priors.slow, &[3.0, 9.0, 40.0]).expect("positive");
        for block in 0..3 {
            assert!(precisions.diagonal(block).iter().all(|value| value.is_finite()), "{block}");
        }
    }
}
