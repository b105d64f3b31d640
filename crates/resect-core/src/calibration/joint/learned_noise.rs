//! Noise levels of a drive, learned on a sample of it.

use std::sync::Arc;

use super::attempt_end::{AttemptEnd, not_definite};
use super::drive::Drive;
use super::equations::ResidualSquares;
use super::gauss_newton_step::{GaussNewtonStep, RowBuffers, step_motion};
use super::linearisation::Weighting;
use super::noise_levels::{FIRST_LEVELS, estimate_noise_levels};
use super::priors::Priors;
use super::residuals::NoiseLevels;
use super::state_vector::StateVector;
use super::trace::{SolverPhase, Trace, TraceRow};
use crate::progress::Progress;

/// Steps of all unknowns of the sample, between which noise levels are estimated.
const SAMPLE_STEPS: usize = 3;
/// Steps of the motion alone before noise levels are estimated: until the motion has followed the constants, their errors count as noise.
const SAMPLE_MOTION_STEPS: usize = 1;
/// Standard deviation of the published positions while noise is estimated: a sample may not determine all that the whole drive
/// does.
const SAMPLE_PRIOR_M: f64 = 0.1;
/// Standard deviation of the published yaws while noise is estimated.
const SAMPLE_PRIOR_RAD: f64 = 0.002;

/// Estimates noise levels on a sample of the drive; returns them with the state of the sample.
pub fn learn_noise(
    sample: &Arc<Drive>,
    priors: &Priors,
    trace: &mut Trace,
    progress: &Progress,
) -> Result<(Weighting, StateVector), AttemptEnd> {
    let mut priors = priors.clone();
    for index in 0..priors.layout.poses() {
        let sigma = if index % 4 == 3 { SAMPLE_PRIOR_RAD } else { SAMPLE_PRIOR_M };
        priors.precision[index] = sigma.powi(-2);
    }
    let squares = ResidualSquares::zeros(priors.layout.stations());
    let distance_m = priors.observed_distance_m(sample.knot_s());
    let levels = NoiseLevels { distance_m, ..FIRST_LEVELS };
    let mut weighting = Weighting { levels, redundancy: 0.5, fixed: None, squares };
    let mut state = sample.initial_state(&priors.mean);
    let mut buffers = RowBuffers::default();
    for round in 0..=SAMPLE_STEPS {
        for _ in 0..SAMPLE_MOTION_STEPS {
            step_motion(sample, &mut state, &weighting, progress)?.ok_or_else(not_definite)?;
            trace.add_row(TraceRow::of_motion(weighting.levels));
        }
        // Residuals of a motion that has not followed the constants yet are not those of noise.
        let squares = step_motion(sample, &mut state, &weighting, progress)?;
        trace.add_row(TraceRow::of_motion(weighting.levels));
        (weighting.levels, weighting.redundancy) =
            estimate_noise_levels(&weighting.levels, &squares.ok_or_else(not_definite)?);
        if round < SAMPLE_STEPS {
            let step =
                GaussNewtonStep::new(sample, &state, &weighting, &priors, &mut buffers, progress)?;
            let step = step.ok_or_else(not_definite)?;
            trace.add_step(step.trace_row(SolverPhase::Sample), step.is_stiffer);
            step.apply(&mut state, 1.0);
            buffers = step.into_buffers();
        }
    }
    Ok((weighting, state))
}
