//! Errors of a position in a station's own frame that its readings alone do not show.

use nalgebra::{Matrix3, Vector3};

use super::facets::FACETS_M;
use super::random_walks::GaussMarkov;
use super::settling::own_settling;
use super::sight::Sight;
use super::unknown::{Effect, Owner, UNKNOWNS};
use crate::calibration::ErrorSizes;

/// Returns the displacements of a position (m) by 1 σ of each error that all positions share, in a fixed order: those of the station, then its
/// settling since it was set up.
///
/// `settled` is the variance of the settling as a share of that of the whole drive.
pub fn shared_errors_m(
    position_m: &Vector3<f64>,
    velocity_m_per_s: &Vector3<f64>,
    settled: f64,
    sizes: &ErrorSizes,
) -> Vec<Vector3<f64>> {
    let sight = Sight::to(position_m);
    let across_m_per_s = velocity_m_per_s - sight.along * velocity_m_per_s.dot(&sight.along);
    let of_station = UNKNOWNS.iter().filter(|unknown| unknown.owner == Owner::Station);
    let mut shared_m: Vec<Vector3<f64>> = of_station
        .filter_map(|unknown| {
            let by_error = match unknown.effect {
                Effect::Reading(error) => (error.correction_m)(&sight),
                Effect::Lean(axis) => Vector3::ith(axis, 1.0).cross(position_m),
                Effect::Latency => across_m_per_s,
                _ => return None,
            };
            Some(by_error * unknown.precision(sizes).sqrt().recip())
        })
        .collect();
    let settling = (own_settling(sizes) * settled).map(f64::sqrt);
    shared_m.extend((0..3).map(|axis| Vector3::ith(axis, settling[axis])));
    shared_m.push(Vector3::z().cross(position_m) * settling[3]);
    shared_m
}

/// Returns the covariance of a position (m²) by these errors, slow errors of the sights, and facets of the prism.
pub fn unseen_covariance_m2(
    position_m: &Vector3<f64>,
    velocity_m_per_s: &Vector3<f64>,
    settled: f64,
    sizes: &ErrorSizes,
) -> Matrix3<f64> {
    let shared_m = shared_errors_m(position_m, velocity_m_per_s, settled, sizes);
    let mut covariance: Matrix3<f64> =
        shared_m.iter().map(|by_error| by_error * by_error.transpose()).sum();
    if sizes.ranges_wander {
        let Sight { along, side, up, .. } = Sight::to(position_m);
        let slow_m2 = GaussMarkov::SMALLEST.sigma_m.powi(2);
        for (axis, facets_m) in [along, side, up].into_iter().zip(FACETS_M) {
            covariance += axis * axis.transpose() * (slow_m2 + facets_m.powi(2));
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
