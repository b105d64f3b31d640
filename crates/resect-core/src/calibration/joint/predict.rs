//! Prediction of the covariance before a drive: the motion is fitted to the readings, then one Gauss–Newton step at the true
//! constants gives it.

use std::sync::Arc;

use super::constants_prior::prior_mean;
use super::drive::{BLOCK_LENGTHS_S, Drive};
use super::equations::ResidualSquares;
use super::gauss_newton_step::{GaussNewtonStep, RowBuffers, step_motion};
use super::joint_estimate::JointEstimate;
use super::linearisation::Weighting;
use super::noise_levels::FIRST_LEVELS;
use super::priors::{Priors, RigDistances};
use super::prism_motion::Solution;
use super::random_walks::GaussMarkov;
use super::readings::DriveReadings;
use super::residuals::NoiseLevels;
use super::state_vector::{Constants, ConstantsMatrix, Layout};
use crate::calibration::ErrorSizes;
use crate::geometry::LevelTransform;
use crate::network::{PerPair, PerStation};
use crate::pipeline::Triplets;
use crate::progress::{Cancelled, Progress};

/// Gauss–Newton steps that fit the motion to the readings.
const MOTION_STEPS: usize = 2;
/// Redundancy number of a reading, on drives of all kinds.
const REDUNDANCY: f64 = 0.6;

/// Noise that an estimate would learn from the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedNoise {
    pub levels: NoiseLevels,
    /// Slow errors of ranges, across the sights, and upward, if [`ErrorSizes::ranges_wander`] is set.
    pub ranges: GaussMarkov,
    pub across: GaussMarkov,
    pub upward: GaussMarkov,
}

impl Default for ExpectedNoise {
    fn default() -> Self {
        // Measured: all real drives have 0.8 mm in range, with correlations of 50 or 200 s.
        let ranges = GaussMarkov { correlation_s: 50.0, ..GaussMarkov::SMALLEST };
        let [across, upward] = [GaussMarkov::SMALLEST; 2];
        Self { levels: FIRST_LEVELS, ranges, across, upward }
    }
}

/// Predicts the joint estimate of readings: its covariance and variance budget, which do not depend on their errors.
///
/// `station1_from_station` are the true poses of the stations, or planned ones; the readings may be noisy or exact. No noise level is
/// estimated and no step is detected. Returns `None` without readings, or if the normal matrix is not positive definite.
pub fn predict(
    triplets: &Triplets,
    layout: &Arc<Layout>,
    (station1_from_station, inter_prism_m): (&PerStation<LevelTransform>, &PerPair<f64>),
    sizes: &ErrorSizes,
    expected: &ExpectedNoise,
    progress: &Progress,
) -> Result<Option<JointEstimate>, Cancelled> {
    let mean = prior_mean(layout, station1_from_station, inter_prism_m);
    let readings = DriveReadings::taken(triplets);
    for block_s in BLOCK_LENGTHS_S {
        let Some(drive) = Drive::new(layout, &readings, block_s) else { return Ok(None) };
        let estimate = predict_step(Arc::new(drive), triplets, &mean, sizes, expected, progress)?;
        if estimate.is_some() {
            return Ok(estimate);
        }
    }
    Ok(None)
}

fn predict_step(
    drive: Arc<Drive>,
    triplets: &Triplets,
    mean: &Constants,
    sizes: &ErrorSizes,
    expected: &ExpectedNoise,
    progress: &Progress,
) -> Result<Option<JointEstimate>, Cancelled> {
    let layout = &drive.layout;
    // Only the information about the distances matters.
    let rig = RigDistances::exact(PerPair::repeat(layout.pairs(), 0.0));
    let mut priors = Priors::new(layout, sizes, mean, &rig, &triplets.restarts_s);
    if sizes.ranges_wander {
        priors.slow.ranges = expected.ranges;
        priors.slow.across = expected.across;
        priors.slow.upward = expected.upward;
    }
    // A prediction has no residuals.
    let (levels, squares) = (expected.levels, ResidualSquares::zeros(layout.stations()));
    let weighting = Weighting { levels, redundancy: REDUNDANCY, fixed: None, squares };
    let mut state = drive.initial_state(mean);
    for _ in 0..MOTION_STEPS {
        if step_motion(&drive, &mut state, &weighting, progress)?.is_none() {
            return Ok(None);
        }
    }
    let mut buffers = RowBuffers::default();
    let step = GaussNewtonStep::new(&drive, &state, &weighting, &priors, &mut buffers, progress)?;
    // Tighter priors would predict a smaller σ.
    let Some(step) = step.filter(|step| !step.is_stiffer) else { return Ok(None) };
    let size = drive.layout.constants;
    let added_covariance = Arc::new(ConstantsMatrix::zeros(size, size));
    let solution = Solution { drive, state, weighting, priors, sizes: *sizes, added_covariance };
    step.summary(solution, progress).map(Some)
}
