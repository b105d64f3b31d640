//! What changes slowly, or at once: what is known of it beforehand, and which steps there are.

use nalgebra::{Matrix4, SMatrix, SVector, Vector3, Vector4};

use super::chain::Linear;
use super::chain_factor::Factor;
use super::drive::Drive;
use super::likelihood::{WANDER_SIGMAS_M, WANDER_TIMES_S};
use super::pass::{Estimates, Model, with_priors};
use super::slow_priors::{SlowPrecisions, SlowPriors, Wander};
use super::stability::{self, Step, Stepped};
use super::unknowns::{Constants, Slow};
use crate::calibration::ErrorSizes;
use crate::progress::{Cancelled, Progress};

/// Steps of stations and clocks that are looked for, at most.
const MOST_STEPS_FOUND: usize = 4;
/// A step this many times the size of what is usual is none of that.
const UNUSUAL: f64 = 4.0;
const LEAST_JUMP_S: f64 = 0.002;

/// What is known beforehand of all that is slow, ranges wandering as little as anything that is tried.
pub fn priors(sizes: &ErrorSizes, start: &Constants, restarts_s: &[f64]) -> SlowPriors {
    SlowPriors {
        settling: settling(sizes, start),
        clocks_s2: sizes.clock_wander_s.powi(2),
        wander: Wander { sigma_m: WANDER_SIGMAS_M[0], correlation_s: WANDER_TIMES_S[1] },
        restarts_s: restarts_s.to_vec(),
        restarted_s2: sizes.clock_offset_s.max(1e-7).powi(2),
        station_steps: Vec::new(),
        clock_steps: Vec::new(),
    }
}

pub fn is_usual(step: &Step, sizes: &ErrorSizes) -> bool {
    match &step.what {
        Stepped::Clock(by_s) => by_s.value.abs() < LEAST_JUMP_S,
        Stepped::Station { turned_rad, .. } => {
            let moved_m = step.moved_m().map_or(0.0, |moved| moved.value);
            turned_rad.value.abs() < UNUSUAL * sizes.settling_rad
                && moved_m < UNUSUAL * sizes.settling_m
        }
    }
}

/// Adds steps of stations and clocks that are not known yet, the clearest first, and gives them room in the priors.
pub fn add_steps(
    known: &mut Vec<Step>,
    linear: &Linear,
    model: &mut Model,
    drive: &Drive,
    at: &Estimates,
    progress: &Progress,
) -> Result<(), Cancelled> {
    while known.len() < MOST_STEPS_FOUND {
        progress.check()?;
        let Some(step) = clearest_step(linear, model, drive, at) else { break };
        let priors = &mut model.priors;
        match step.what {
            Stepped::Station { .. } => priors.station_steps.push(step.part),
            Stepped::Clock(_) => priors.clock_steps.push(step.part),
        }
        known.push(step);
    }
    progress.check()
}

fn clearest_step(linear: &Linear, model: &Model, drive: &Drive, at: &Estimates) -> Option<Step> {
    let slow_priors = SlowPrecisions::new(&model.priors, &drive.part_times_s)?;
    let right = with_priors(linear, model, &slow_priors, at);
    let (factor, ahead) = Factor::new(&linear.data, &model.precision, &slow_priors, right)?;
    let slow: Vec<Slow> = at.slow.iter().zip(&ahead.slow).map(|(at, ahead)| at - ahead).collect();
    stability::clearest_step(&search(&factor, &slow_priors, &slow, model, drive, at))
}

/// Known steps, as large as the whole solution makes them; where there is none, a station that moved slowly.
pub fn measured(
    known: &[Step],
    factor: &Factor,
    model: &Model,
    drive: &Drive,
    at: &Estimates,
) -> Vec<Step> {
    let usual =
        SlowPriors { station_steps: Vec::new(), clock_steps: Vec::new(), ..model.priors.clone() };
    let Some(usual) = SlowPrecisions::new(&usual, &drive.part_times_s) else {
        return known.to_vec();
    };
    let search = search(factor, &usual, &at.slow, model, drive, at);
    if known.is_empty() {
        return stability::clearest_drift(&search).into_iter().collect();
    }
    let measured = |step: &Step| stability::measured(&search, step).unwrap_or_else(|| step.clone());
    known.iter().map(measured).collect()
}

fn search<'a>(
    factor: &'a Factor,
    slow_priors: &'a SlowPrecisions,
    slow: &'a [Slow],
    model: &'a Model,
    drive: &'a Drive,
    at: &Estimates,
) -> stability::Search<'a> {
    stability::Search {
        factor,
        slow_priors,
        slow,
        part_times_s: &drive.part_times_s,
        known: [&model.priors.station_steps, &model.priors.clock_steps],
        places_m: [0, 1].map(|slot| at.constants.fixed_rows::<3>(4 * slot).into()),
    }
}

/// Variance of how stations 2 and 3 walk against station 1, which walks as well.
fn settling(sizes: &ErrorSizes, start: &Constants) -> SMatrix<f64, 8, 8> {
    let (own, by_first) = (own_settling(sizes), by_station_1(start));
    let both = SVector::<f64, 8>::from_fn(|k, _| own[k % 4]);
    SMatrix::from_diagonal(&both) + by_first * Matrix4::from_diagonal(&own) * by_first.transpose()
}

/// How far station 1 has moved and turned (m, rad) where stations 2 and 3 walked against it, and the variance that this
/// leaves after a whole drive: what is known of three that walk alike, of which two differences are seen.
pub fn station_1_by_slow(
    sizes: &ErrorSizes,
    start: &Constants,
) -> (SMatrix<f64, 4, 8>, Matrix4<f64>) {
    let own = Matrix4::from_diagonal(&own_settling(sizes));
    let with_slow = own * by_station_1(start).transpose();
    let Some(both) = settling(sizes, start).cholesky() else { return (SMatrix::zeros(), own) };
    let by_slow = with_slow * both.inverse();
    (by_slow, own - by_slow * with_slow.transpose())
}

/// Variance of how far one station walks during a drive, along x, y, z (m²) and about z (rad²).
fn own_settling(sizes: &ErrorSizes) -> Vector4<f64> {
    Vector4::new(
        sizes.settling_m.powi(2),
        sizes.settling_m.powi(2),
        sizes.settling_m.powi(2),
        sizes.settling_rad.powi(2),
    )
    .map(|variance| variance.max(1e-14))
}

/// How stations 2 and 3 move and turn in the frame of station 1 when that does.
fn by_station_1(start: &Constants) -> SMatrix<f64, 8, 4> {
    let mut by_first = SMatrix::<f64, 8, 4>::zeros();
    for slot in 0..2 {
        let place: Vector3<f64> = start.fixed_rows::<3>(4 * slot).into();
        let mut turned = Matrix4::identity();
        turned.fixed_view_mut::<3, 1>(0, 3).copy_from(&Vector3::z().cross(&place));
        by_first.fixed_rows_mut::<4>(4 * slot).copy_from(&-turned);
    }
    by_first
}
