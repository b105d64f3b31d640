//! Iteration of the adjustment of a survey ([`super::survey_adjustment`]).

use std::sync::Arc;

use nalgebra::Vector3;

use super::constants_prior::prior_mean;
use super::state_vector::{Layout, by_station};
use super::survey::{Survey, survey_precisions};
use super::survey_adjustment::{Adjustment, STATED_NUMBERS};
use super::survey_conflicts;
use super::survey_markers::markers;
use super::survey_reliability::{critical_sigmas, noise_numbers};
use crate::calibration::{CalibrationSettings, ErrorSizes};
use crate::deployment::{ControlPointSet, Deployment};
use crate::geometry::{LevelTransform, align_level};
use crate::network::{Number, PerPair, PerStation, Station};

/// Fewest points that each other station shares with station 1.
const FEWEST_SHARED: usize = 3;
/// Largest number of iterations of the adjustment.
const MOST_ITERATIONS: usize = 60;
/// The iteration has converged once no constant moves by more than this many σ.
const CONVERGED_SIGMAS: f64 = 1e-3;
/// It goes on while a noise factor changes by more than this share.
const CONVERGED_SHARE: f64 = 1e-3;
/// Iterations from one computation of σ and redundancy numbers, which change slowly, to the next.
const REDUNDANCY_PERIOD: usize = 4;

/// Adjusts the control points of a deployment if the settings use them.
pub fn of_deployment(
    deployment: &Deployment,
    layout: &Arc<Layout>,
    settings: &CalibrationSettings,
) -> Option<Arc<Survey>> {
    let sets = deployment.comparable_control_points();
    if !settings.evidence.control_points {
        return None;
    }
    adjust(sets, layout, &settings.errors).map(Arc::new)
}

/// Adjusts the control points of a deployment; `None` unless each other station shares three points with station 1.
pub fn adjust(
    sets: &[ControlPointSet],
    layout: &Arc<Layout>,
    sizes: &ErrorSizes,
) -> Option<Survey> {
    let published = approximate_transforms(sets, layout.stations())?;
    let mean = prior_mean(layout, &published, &PerPair::default());
    let mut adjustment = Adjustment {
        layout: Arc::clone(layout),
        constants: mean.clone(),
        mean,
        precision: survey_precisions(layout, sizes),
        markers: sets.iter().map(markers).collect(),
        frames: vec![LevelTransform::IDENTITY; sets.len()],
        noise_factors: Vector3::repeat(1.0),
        noise_numbers: Vector3::repeat(STATED_NUMBERS),
        tested: Vec::new(),
    };
    adjustment.place_frames();
    let mut redundancy = Vec::new();
    for iteration in 0..MOST_ITERATIONS {
        let equations = adjustment.linearise();
        let factor = equations.with_priors(&adjustment.precision).cholesky()?;
        let gradient = &equations.gradient + &adjustment.precision * adjustment.deviation();
        let step = factor.solve(&gradient);
        let mut is_converged = false;
        if iteration % REDUNDANCY_PERIOD == 0 {
            let covariance = factor.inverse();
            let sigmas =
                step.zip_map(&covariance.diagonal(), |step, variance| step.abs() / variance.sqrt());
            is_converged = sigmas.max() < CONVERGED_SIGMAS;
            let readings = adjustment.reliability(&equations.frames, &covariance);
            redundancy = readings.into_iter().map(|reading| reading.redundancy).collect();
        }
        let change = adjustment.reweight(&equations.residuals_m, &redundancy);
        adjustment.apply(&step, &equations.frames);
        if is_converged && change < CONVERGED_SHARE {
            break;
        }
    }
    let equations = adjustment.linearise();
    let covariance = equations.with_priors(&adjustment.precision).cholesky()?.inverse();
    let mut readings = adjustment.reliability(&equations.frames, &covariance);
    adjustment.noise_numbers = noise_numbers(&readings);
    let critical_sigmas = critical_sigmas(&readings, &adjustment.noise_numbers);
    readings.iter_mut().for_each(|reading| reading.critical_sigmas = critical_sigmas);
    let face_errors = adjustment.face_errors(&covariance);
    let tests = survey_conflicts::tests(&mut adjustment, sizes);
    let survey = adjustment.into_survey(&equations, readings, tests);
    Some(Survey { face_errors, ..survey })
}

/// Level transforms by the points that two stations share, as method B.
fn approximate_transforms(
    sets: &[ControlPointSet],
    stations: usize,
) -> Option<PerStation<LevelTransform>> {
    let points = || sets.iter().flat_map(|set| &set.points);
    let transform = |station: usize| {
        let shared = points().filter_map(|point| {
            let reading = |station| Some((*point.readings.get(station)?)?.to_cartesian());
            Some((reading(Station::FIRST)?, reading(Station::at(station))?))
        });
        let (to_m, from_m): (Vec<_>, Vec<_>) = shared.unzip();
        (to_m.len() >= FEWEST_SHARED).then(|| align_level(&to_m, &from_m))?
    };
    let others: Option<Vec<LevelTransform>> = (1..stations).map(transform).collect();
    Some(by_station(LevelTransform::IDENTITY, others?))
}

#[cfg(test)]
pub mod tests;
