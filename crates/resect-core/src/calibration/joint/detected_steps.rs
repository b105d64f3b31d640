//! Steps of stations and clocks: their detection between Gauss–Newton steps, and their size in the final solution.

use std::mem::discriminant;

use super::chain::ChainVector;
use super::chain_factor::ChainFactor;
use super::drive::Drive;
use super::facets::{facet_effects, incidence_terms};
use super::gauss_newton_step::GaussNewtonStep;
use super::height_curvature::height_curvature;
use super::priors::Priors;
use super::random_walks::{SlowPrecisions, SlowPriors};
use super::state_vector::{Slow, StateVector};
use super::step_search::{StationStep, StepSearch, StepSize};
use crate::calibration::ErrorSizes;
use crate::progress::{Cancelled, Progress};

/// Largest number of steps that are detected.
const MOST_STEPS: usize = 4;
/// A step of a station of more prior standard deviations of settling is unusual, and the answer weak.
const UNUSUAL_SIGMAS: f64 = 4.0;
/// A larger jump of a clock is unusual, and the answer weak.
const UNUSUAL_JUMP_S: f64 = 0.002;

/// Returns true for a step of the size that instruments in the field are expected to make.
pub fn is_usual(step: &StationStep, sizes: &ErrorSizes) -> bool {
    match &step.size {
        StepSize::Clock(by_s) => by_s.value.abs() < UNUSUAL_JUMP_S,
        StepSize::Station { turned_rad, .. } => {
            let moved_m = step.moved_m().map_or(0.0, |moved| moved.value);
            turned_rad.value.abs() < UNUSUAL_SIGMAS * sizes.settling_rad
                && moved_m < UNUSUAL_SIGMAS * sizes.settling_m
        }
    }
}

/// Adds significant steps, the most significant first, and raises the variance of their increments in the priors.
pub fn add_steps(
    steps: &mut Vec<StationStep>,
    linearised: &GaussNewtonStep,
    priors: &mut Priors,
    state: &StateVector,
    progress: &Progress,
) -> Result<(), Cancelled> {
    while steps.len() < MOST_STEPS {
        progress.check()?;
        let step = most_significant_step(linearised, priors, state, progress);
        let Some(step) = step else { break };
        match step.size {
            StepSize::Station { .. } => priors.slow.station_steps.push(step.block),
            StepSize::Clock(_) => priors.slow.clock_steps.push(step.block),
        }
        steps.push(step);
    }
    progress.check()
}

fn most_significant_step(
    linearised: &GaussNewtonStep,
    priors: &Priors,
    state: &StateVector,
    progress: &Progress,
) -> Option<StationStep> {
    let normal = &linearised.normal;
    let drive = normal.drive();
    let precisions = SlowPrecisions::of_drive(&priors.slow, drive)?;
    let right = normal.gradient_with_priors(priors, &precisions, state);
    let (factor, step) =
        ChainFactor::new(&normal.matrix, &priors.information(), &precisions, &right)?;
    let solved = state.slow.iter().zip(&step.slow).map(|(slow, step)| slow - step);
    let slow: Vec<Slow> = solved.collect();
    let search = step_search(&factor, &precisions, &slow, priors, drive, state);
    let terms = incidence_terms(drive, state);
    let by_incidence = |solution: &ChainVector| {
        let information = normal.matrix.multiply(std::slice::from_ref(solution));
        facet_effects(drive, &terms, &information[0])
    };
    // A cancelled one is noticed by the next check.
    search.most_significant_step(by_incidence, |directions, heights| {
        let priors = (priors, &precisions);
        height_curvature(linearised, state, priors, directions, heights, progress).ok()
    })
}

/// Returns the steps with their size in the final solution; without a step, a significant drift of one station over the whole drive.
pub fn measured_steps(
    steps: &[StationStep],
    factor: &ChainFactor,
    priors: &Priors,
    drive: &Drive,
    state: &StateVector,
) -> Vec<StationStep> {
    let (station_steps, clock_steps) = (Vec::new(), Vec::new());
    let without_steps = SlowPriors { station_steps, clock_steps, ..priors.slow.clone() };
    let Some(precisions) = SlowPrecisions::of_drive(&without_steps, drive) else {
        return steps.to_vec();
    };
    let search = step_search(factor, &precisions, &state.slow, priors, drive, state);
    if steps.is_empty() {
        return search.most_significant_drift().into_iter().collect();
    }
    let measured =
        |span: StepSpan| search.measure(&span.step, span.last_block).unwrap_or(span.step);
    spans_of_steps(steps).into_iter().map(measured).collect()
}

/// A step that happens from its block to a last one.
struct StepSpan {
    step: StationStep,
    last_block: usize,
}

/// Returns the steps, those of a station or of a clock in consecutive blocks as one: a tripod that is knocked within a block differs
/// from the blocks on both sides.
fn spans_of_steps(steps: &[StationStep]) -> Vec<StepSpan> {
    let mut in_order: Vec<&StationStep> = steps.iter().collect();
    in_order.sort_by_key(|step| step.block);
    let mut spans: Vec<StepSpan> = Vec::new();
    for step in in_order {
        let is_continued = |span: &&mut StepSpan| {
            span.step.station == step.station
                && discriminant(&span.step.size) == discriminant(&step.size)
                && span.last_block + 1 == step.block
        };
        match spans.iter_mut().find(is_continued) {
            Some(span) => span.last_block = step.block,
            None => spans.push(StepSpan { step: step.clone(), last_block: step.block }),
        }
    }
    let significance =
        |span: &StepSpan| steps.iter().position(|step| step.block == span.step.block);
    spans.sort_by_key(significance);
    spans
}

fn step_search<'a>(
    factor: &'a ChainFactor,
    precisions: &'a SlowPrecisions,
    slow: &'a [Slow],
    priors: &'a Priors,
    drive: &'a Drive,
    state: &'a StateVector,
) -> StepSearch<'a> {
    StepSearch {
        layout: &drive.layout,
        factor,
        precisions,
        slow,
        block_times_s: &drive.block_times_s,
        known_blocks: [&priors.slow.station_steps, &priors.slow.clock_steps],
        constants: &state.constants,
        settling: priors.own_settling,
    }
}
