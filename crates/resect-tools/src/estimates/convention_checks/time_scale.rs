//! Units and rates of an estimate's clock.

use std::sync::Arc;

use super::unit_of_length::{ShapeFit, compare_shapes};
use crate::estimates::ground_truth::GroundTruth;
use crate::estimates::pose_interpolation::median_interval_s;
use resect_core::deployment::{EstimatedPose, EstimatedTrajectory};
use resect_core::evaluation::no_trajectory::NoTrajectory;

/// A clock that runs faster or slower than that of the ground truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SuspectedRate {
    /// Seconds of the ground truth per second of the estimate.
    pub factor: f64,
    /// Word of the unit, if the factor is one.
    pub unit: Option<&'static str>,
    /// Errors relative to the size of the drive: as read, if the times overlap, and with the factor.
    pub as_read: Option<f64>,
    pub with_factor: f64,
}

impl SuspectedRate {
    /// Returns true if the numbers with the clock as read have no meaning.
    pub fn excludes_judgement(&self) -> bool {
        self.unit.is_some() || self.as_read.is_none_or(|misfit| misfit > MEANINGLESS)
    }
}

/// Units of stamps that are read as seconds.
const UNITS: [(f64, &str); 3] = [(1e-3, "ms"), (1e-6, "us"), (1e-9, "ns")];
/// Rates of recordings: frame rates that are confused, and bags that are played slower or faster.
const RATES: [f64; 22] = [
    1000.0 / 1001.0,
    1001.0 / 1000.0,
    0.99,
    1.0 / 0.99,
    1.01,
    1.0 / 1.01,
    24.0 / 25.0,
    25.0 / 24.0,
    0.95,
    1.0 / 0.95,
    1.05,
    1.0 / 1.05,
    0.9,
    1.0 / 0.9,
    1.1,
    1.0 / 1.1,
    0.8,
    1.25,
    0.5,
    2.0,
    0.1,
    10.0,
];
/// A factor is believed if the shapes fit this many times better than as read, and to this share of the size.
const TIMES_BETTER: f64 = 3.0;
const LARGEST_MISFIT: f64 = 0.05;
/// As-read shapes that fit better than this have no other rate that this search could find.
const GOOD_FIT: f64 = 0.01;
/// The search around a rate begins below this misfit only. A trajectory of another drive has a larger one at all rates.
const NEAR_MISFIT: f64 = 0.2;
/// Above this misfit the numbers with the clock as read have no meaning.
const MEANINGLESS: f64 = 0.3;
/// Relative difference within which a rate is the one of the list.
const SAME_RATE: f64 = 3e-4;
/// Number of steps of the search around a rate.
const STEPS: usize = 12;

/// Ratio of durations beyond which two trajectories are not of one drive in one unit.
const LONGEST_RATIO: f64 = 30.0;
/// Largest median interval of a ground truth whose rate is compared (s): surveyed points have no speed.
const SPARSE_S: f64 = 0.6;

/// Returns the unit of stamps with which an estimate has the duration and the shape of the ground truth; `None` as read.
pub fn suspected_unit_of_time(
    truth: &Arc<EstimatedTrajectory>,
    poses: &[EstimatedPose],
) -> Result<Option<SuspectedRate>, NoTrajectory> {
    let ratio = duration_s(poses) / duration_s(&truth.poses);
    if !ratio.is_finite() || ratio < LONGEST_RATIO {
        return Ok(None);
    }
    for (factor, word) in UNITS {
        if !(LONGEST_RATIO.recip()..LONGEST_RATIO).contains(&(factor * ratio)) {
            continue;
        }
        let misfit = misfit(truth, poses, factor)?;
        if misfit < LARGEST_MISFIT {
            return Ok(Some(SuspectedRate {
                factor,
                unit: Some(word),
                as_read: None,
                with_factor: misfit,
            }));
        }
    }
    Ok(None)
}

fn duration_s(poses: &[EstimatedPose]) -> f64 {
    poses.first().zip(poses.last()).map_or(0.0, |(first, last)| last.time_s - first.time_s)
}

fn misfit(
    truth: &Arc<EstimatedTrajectory>,
    poses: &[EstimatedPose],
    factor: f64,
) -> Result<f64, NoTrajectory> {
    let truth = GroundTruth::Trajectory(Arc::clone(truth), None);
    let fit = compare_shapes(&truth, &with_rate(poses, factor), None)?;
    Ok(fit.map_or(f64::INFINITY, |fit| fit.relative_misfit))
}

/// Returns the rate at which the shapes fit much better than as read; `None` if there is none.
pub fn suspected_rate(
    truth: &Arc<EstimatedTrajectory>,
    poses: &[EstimatedPose],
    as_read: Option<ShapeFit>,
) -> Result<Option<SuspectedRate>, NoTrajectory> {
    let is_good = as_read.is_some_and(|fit| fit.relative_misfit < GOOD_FIT);
    let is_sparse = |poses: &[EstimatedPose]| median_interval_s(poses) > SPARSE_S;
    let ratio = duration_s(poses) / duration_s(&truth.poses);
    let is_comparable = (LONGEST_RATIO.recip()..LONGEST_RATIO).contains(&ratio);
    if is_good || !is_comparable || is_sparse(&truth.poses) {
        return Ok(None);
    }
    let (mut factor, mut value) = (1.0, f64::INFINITY);
    let interval_s = median_interval_s(poses);
    for rate in RATES.into_iter().filter(|rate| rate * interval_s <= SPARSE_S) {
        let misfit = misfit(truth, poses, rate)?;
        if misfit < value {
            (factor, value) = (rate, misfit);
        }
    }
    if value > NEAR_MISFIT {
        return Ok(None);
    }
    let mut step = 2e-3;
    for _ in 0..STEPS {
        let [slower, faster] = [factor * (1.0 - step), factor * (1.0 + step)];
        let misfits = [misfit(truth, poses, slower)?, misfit(truth, poses, faster)?];
        if misfits[0] < value && misfits[0] <= misfits[1] {
            (factor, value) = (slower, misfits[0]);
        } else if misfits[1] < value {
            (factor, value) = (faster, misfits[1]);
        } else {
            step *= 0.5;
        }
    }
    // Recordings are played at simple rates; lever arms make the search less exact.
    if let Some(rate) = RATES.into_iter().find(|rate| (factor / rate - 1.0).abs() < SAME_RATE) {
        (factor, value) = (rate, misfit(truth, poses, rate)?);
    }
    let as_read = as_read.map(|fit| fit.relative_misfit);
    let limit =
        as_read.map_or(LARGEST_MISFIT, |as_read| LARGEST_MISFIT.min(as_read / TIMES_BETTER));
    let rate = SuspectedRate { factor, unit: None, as_read, with_factor: value };
    Ok((value < limit).then_some(rate))
}

/// Poses with a factor on the times since the first.
fn with_rate(poses: &[EstimatedPose], factor: f64) -> Vec<EstimatedPose> {
    let Some(first) = poses.first() else { return Vec::new() };
    let scaled = |pose: &EstimatedPose| EstimatedPose {
        time_s: first.time_s + factor * (pose.time_s - first.time_s),
        ..*pose
    };
    poses.iter().map(scaled).collect()
}
