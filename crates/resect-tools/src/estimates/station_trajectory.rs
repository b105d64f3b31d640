//! The trajectory of one station's prism in the station's own frame, without a calibration.

use nalgebra::{Matrix3, Vector3};

use resect_core::analysis::Analysis;
use resect_core::calibration::ErrorSizes;
use resect_core::deployment::{Deployment, EstimatedPose, EstimatedTrajectory, PoseCovariance};
use resect_core::pipeline::interpolation::{grid, white_noise_on_acceleration};
use resect_core::pipeline::interval_filter;
use resect_core::pipeline::interval_split::uninterrupted;
use resect_core::progress::Progress;

/// Largest rate of the positions (Hz), above that of any total station.
const MOST_HZ: f64 = 10.0;

/// A number that no station has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no station {number}; the deployment has stations 1 to {stations}")]
pub struct NoStation {
    pub number: usize,
    pub stations: usize,
}

/// Returns the index of a station from its number.
pub fn station_index(deployment: &Deployment, number: usize) -> Result<usize, NoStation> {
    let stations = deployment.tracks.len();
    if (1..=stations).contains(&number) {
        Ok(number - 1)
    } else {
        Err(NoStation { number, stations })
    }
}

/// Returns positions of a station's prism in its own frame, with covariance; without poses if no interval is long enough.
///
/// The motion model (white noise on acceleration) smooths the readings that pass the outlier filter, in intervals by τ_s and
/// τ_l. Its covariance is that of the readings' noise. The priors of the instrument's errors are added, because nothing
/// estimates them: additive and scale error of ranges, vertical index, collimation, and the age of the angles.
pub fn station_trajectory(
    deployment: &Deployment,
    analysis: &Analysis,
    station: usize,
) -> EstimatedTrajectory {
    let settings = &analysis.settings.pipeline;
    let thresholds = &settings.thresholds;
    let filtered = &analysis.pipeline.filtered[station];
    let intervals = uninterrupted(filtered, thresholds.tau_s_seconds);
    let shortest_s = settings.interval_filter.then_some(thresholds.tau_l_seconds);
    let intervals = interval_filter::filter(&intervals, shortest_s);
    let (time_s, interval) = grid(&intervals, settings.rate_hz.min(MOST_HZ));
    let smoothed = white_noise_on_acceleration::at(
        filtered,
        &intervals,
        (&time_s, &interval),
        &Progress::default(),
    )
    .expect("nobody else can cancel it");
    let poses: Vec<EstimatedPose> = time_s
        .iter()
        .zip(&smoothed.points_m)
        .map(|(time_s, position_m)| EstimatedPose {
            time_s: *time_s,
            position_m: *position_m,
            orientation: None,
        })
        .collect();
    let sizes = &analysis.settings.calibration.errors;
    let covariances = (0..poses.len()).map(|index| {
        let noise = PoseCovariance::of_position(&smoothed.sigma_m[index]);
        let velocity = velocity_m_per_s(&poses, &interval, index);
        let systematic = instrument_covariance_m2(&poses[index].position_m, &velocity, sizes);
        PoseCovariance { position_m2: noise.position_m2 + systematic, ..noise }
    });
    let covariances = covariances.collect();
    EstimatedTrajectory {
        name: format!("{} station {}", deployment.name, station + 1),
        path: deployment.name.clone().into(),
        topic: None,
        poses,
        covariances,
        findings: Vec::new(),
    }
}

/// Velocity at an instant (m/s) by differences with its neighbours in the same interval.
fn velocity_m_per_s(poses: &[EstimatedPose], interval: &[u32], index: usize) -> Vector3<f64> {
    let beside = |other: Option<usize>| {
        other.filter(|other| interval.get(*other) == interval.get(index)).unwrap_or(index)
    };
    let (before, after) = (beside(index.checked_sub(1)), beside(Some(index + 1)));
    let elapsed_s = poses[after].time_s - poses[before].time_s;
    if elapsed_s > 0.0 {
        (poses[after].position_m - poses[before].position_m) / elapsed_s
    } else {
        Vector3::zeros()
    }
}

/// Covariance (m²) of a position at rest or in motion by the priors of the instrument's errors, in the station's frame.
fn instrument_covariance_m2(
    position_m: &Vector3<f64>,
    velocity_m_per_s: &Vector3<f64>,
    sizes: &ErrorSizes,
) -> Matrix3<f64> {
    let range_m = position_m.norm();
    let along = position_m / range_m.max(1e-9);
    let level = Vector3::z().cross(&along);
    // Straight up, every horizontal direction is across.
    let level = level.try_normalize(1e-9).unwrap_or_else(Vector3::x);
    let across = along.cross(&level);
    let outer = |direction: &Vector3<f64>, variance_m2: f64| {
        direction * direction.transpose() * variance_m2
    };
    let range_m2 = sizes.range_offset_m.powi(2) + (sizes.range_scale * range_m).powi(2);
    let tangential = velocity_m_per_s - along * velocity_m_per_s.dot(&along);
    outer(&along, range_m2)
        + outer(&level, (sizes.collimation_rad * range_m).powi(2))
        + outer(&across, (sizes.index_rad * range_m).powi(2))
        + outer(&tangential, sizes.latency_s.powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instrument_errors_grow_with_range_and_speed_in_their_directions() {
        let sizes = ErrorSizes::default();
        let sigma_m = |position_m: Vector3<f64>, velocity: Vector3<f64>| {
            instrument_covariance_m2(&position_m, &velocity, &sizes).diagonal().map(f64::sqrt)
        };
        let far = sigma_m(Vector3::new(100.0, 0.0, 0.0), Vector3::zeros());
        assert!((far.x - 0.0012_f64.hypot(0.0007)).abs() < 1e-9, "{far}");
        assert!((far.y - 100.0 * sizes.collimation_rad).abs() < 1e-9, "{far}");
        assert!((far.z - 100.0 * sizes.index_rad).abs() < 1e-9, "{far}");
        let passing = sigma_m(Vector3::new(5.0, 0.0, 0.0), Vector3::new(1.0, 1.0, 0.0));
        assert!((passing.y - 0.01).abs() < 1e-4 && passing.x < 0.0013, "{passing}");
    }
}
