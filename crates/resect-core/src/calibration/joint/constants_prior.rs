//! Prior of the constants: mean and precision.

use nalgebra::Vector3;

use super::sight::EARTH_RADIUS_M;
use super::state_vector::{Constants, Layout};
use super::unknown::{DISTANCE, LEAN_X, LEAN_Y};
use crate::calibration::ErrorSizes;
use crate::geometry::LevelTransform;
use crate::network::{Number, PerPair, PerStation};

/// Precisions (1/σ²) of the constants; zero for the transforms, which have no prior.
pub fn precisions(layout: &Layout, sizes: &ErrorSizes) -> Constants {
    let mut precision = Constants::zeros(layout.constants);
    for (unknown, _, index) in layout.each() {
        precision[index] = unknown.precision(sizes);
    }
    precision
}

/// Returns the prior mean of the constants: a published answer, the measured distances of the followed prisms (m), and leans by the
/// curvature of the earth.
pub fn prior_mean(
    layout: &Layout,
    published: &PerStation<LevelTransform>,
    inter_prism_m: &PerPair<f64>,
) -> Constants {
    let mut constants = Constants::zeros(layout.constants);
    for (station, transform) in published.each() {
        let Some(slot) = station.slot() else { continue };
        constants.fixed_rows_mut::<3>(4 * slot).copy_from(&transform.translation_m);
        constants[4 * slot + 3] = transform.yaw_rad;
        // The plumb line of a distant station leans away from station 1.
        let away = Vector3::new(transform.translation_m.x, transform.translation_m.y, 0.0);
        let lean = transform.inverse().rotate(&Vector3::z().cross(&away)) / EARTH_RADIUS_M;
        constants[layout.index(&LEAN_X, station.index())] = lean.x;
        constants[layout.index(&LEAN_Y, station.index())] = lean.y;
    }
    for (index, distance_m) in layout.indices(&DISTANCE).zip(inter_prism_m) {
        constants[index] = *distance_m;
    }
    constants
}
