//! The trajectory of one station's prism in the station's own frame, without a calibration.

use nalgebra::{DMatrix, Vector3};

use resect_core::analysis::Analysis;
use resect_core::calibration::ErrorSizes;
use resect_core::calibration::joint::prism_motion::ConstantsJacobian;
use resect_core::calibration::joint::{shared_errors_m, unseen_covariance_m2};
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
/// τ_l. Its covariance is that of the readings' noise, and of the errors that one station alone does not show.
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
    // Tripods settle since the first reading.
    let start_s = poses.first().map_or(0.0, |pose| pose.time_s);
    let length_s = poses.last().map_or(1.0, |pose| (pose.time_s - start_s).max(1e-9));
    let covariances = (0..poses.len()).map(|index| {
        let noise = PoseCovariance::of_position(&smoothed.sigma_m[index]);
        let velocity = velocity_m_per_s(&poses, &interval, index);
        let position_m = &poses[index].position_m;
        let settled = (poses[index].time_s - start_s) / length_s;
        let systematic = unseen_covariance_m2(position_m, &velocity, settled, sizes);
        PoseCovariance { position_m2: noise.position_m2 + systematic, ..noise }
    });
    let covariances = covariances.collect();
    EstimatedTrajectory {
        name: format!("{} station {}", deployment.name, station + 1),
        path: deployment.name.clone().into(),
        topic: None,
        frames: None,
        poses,
        covariances,
        origin: None,
        findings: Vec::new(),
    }
}

/// Errors of a station that all of its positions share, of 1 σ: the displacements at each time by each of them.
pub fn shared_errors(
    truth: &EstimatedTrajectory,
    times_s: &[f64],
    sizes: &ErrorSizes,
) -> ConstantsJacobian {
    let poses = &truth.poses;
    let none = ConstantsJacobian::default();
    let [Some(first), Some(last)] = [poses.first(), poses.last()] else { return none };
    let length_s = (last.time_s - first.time_s).max(1e-9);
    let interval = vec![0; poses.len()];
    let by_errors = |time_s: &f64| {
        let next = poses.partition_point(|pose| pose.time_s < *time_s).min(poses.len() - 1);
        let velocity = velocity_m_per_s(poses, &interval, next);
        // A tripod settles gradually, so its displacement grows with the share of the drive.
        let settled = ((time_s - first.time_s) / length_s).clamp(0.0, 1.0).powi(2);
        let shared_m = shared_errors_m(&poses[next].position_m, &velocity, settled, sizes);
        let by_error = DMatrix::from_fn(3, shared_m.len(), |row, column| shared_m[column][row]);
        (*time_s, by_error)
    };
    let instants: Vec<(f64, DMatrix<f64>)> = times_s.iter().map(by_errors).collect();
    let errors = instants.first().map_or(0, |(_, by_error)| by_error.ncols());
    ConstantsJacobian { instants, covariance: DMatrix::identity(errors, errors) }
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
