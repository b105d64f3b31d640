//! Prior of the constants: mean and precision.

use nalgebra::Vector3;

use super::state_vector::{
    CLOCKS, COLLIMATIONS, CONSTANTS, Constants, DISTANCES, DRIFTS, INDICES, LATENCIES, LEANS,
    OFFSETS, SCALES,
};
use super::station_model::EARTH_RADIUS_M;
use crate::calibration::ErrorSizes;
use crate::geometry::LevelTransform;
use crate::network::PerStation;

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
pub fn prior_mean(
    published: &PerStation<LevelTransform>,
    inter_prism_m: Option<&[f64; 3]>,
) -> Constants {
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
