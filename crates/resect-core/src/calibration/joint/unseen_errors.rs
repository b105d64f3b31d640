//! Errors of a position in a station's own frame that its readings alone do not show.

use nalgebra::{Matrix3, Vector3};

use super::facets::FACETS_M;
use super::random_walks::GaussMarkov;
use super::settling::own_settling;
use super::sight::Sight;
use super::unknown::{Effect, Owner, UNKNOWNS};
use crate::calibration::ErrorSizes;

/// Returns the covariance of a position (m²) by the priors of the station's errors, its settling since it was set up, slow errors of the
/// sights, and facets of the prism.
///
/// `settled` is the share of the drive that has passed, during which the tripod settled.
pub fn unseen_covariance_m2(
    position_m: &Vector3<f64>,
    velocity_m_per_s: &Vector3<f64>,
    settled: f64,
    sizes: &ErrorSizes,
) -> Matrix3<f64> {
    let sight = Sight::to(position_m);
    let across_m_per_s = velocity_m_per_s - sight.along * velocity_m_per_s.dot(&sight.along);
    let mut covariance = Matrix3::zeros();
    let mut add = |by_error: Vector3<f64>, variance: f64| {
        covariance += by_error * by_error.transpose() * variance;
    };
    for unknown in UNKNOWNS.iter().filter(|unknown| unknown.owner == Owner::Station) {
        let by_error = match unknown.effect {
            Effect::Reading(error) => (error.correction_m)(&sight),
            Effect::Lean(axis) => Vector3::ith(axis, 1.0).cross(position_m),
            Effect::Latency => across_m_per_s,
            _ => continue,
        };
        add(by_error, unknown.precision(sizes).recip());
    }
    let settling = own_settling(sizes) * settled;
    (0..3).for_each(|axis| add(Vector3::ith(axis, 1.0), settling[axis]));
    add(Vector3::z().cross(position_m), settling[3]);
    if sizes.ranges_wander {
        let slow_m2 = GaussMarkov::SMALLEST.sigma_m.powi(2);
        for (axis, facets_m) in [sight.along, sight.side, sight.up].into_iter().zip(FACETS_M) {
            add(axis, slow_m2 + facets_m.powi(2));
        }
    }
    covariance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_grow_with_range_speed_and_time_in_their_directions() {
        let sizes = ErrorSizes { ranges_wander: false, refraction: 0.0, ..ErrorSizes::default() };
        let sigma_m = |position_m: Vector3<f64>, velocity: Vector3<f64>, settled: f64| {
            unseen_covariance_m2(&position_m, &velocity, settled, &sizes).diagonal().map(f64::sqrt)
        };
        let far = sigma_m(Vector3::new(100.0, 0.0, 0.0), Vector3::zeros(), 0.0);
        assert!((far.x - 0.0012_f64.hypot(0.0007)).abs() < 1e-6, "{far}");
        assert!((far.y - 100.0 * sizes.collimation_rad).abs() < 1e-6, "{far}");
        assert!((far.z - 100.0 * sizes.index_rad.hypot(sizes.lean_rad)).abs() < 1e-6, "{far}");
        let later = sigma_m(Vector3::new(100.0, 0.0, 0.0), Vector3::zeros(), 1.0);
        let settled_m = sizes.settling_m.hypot(100.0 * sizes.settling_rad);
        assert!((later.y - far.y.hypot(settled_m)).abs() < 1e-6, "{later}");
        let passing = sigma_m(Vector3::new(5.0, 0.0, 0.0), Vector3::new(1.0, 1.0, 0.0), 0.0);
        assert!((passing.y - 0.01).abs() < 1e-4 && passing.x < 0.0013, "{passing}");
    }
}
