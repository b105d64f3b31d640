//! Beyond the paper: method D with a robust loss, weights from the instruments' noise, and what else can be estimated:
//! the clocks of stations 2 and 3, the inter-prism distances, the tilts of stations 2 and 3.
//!
//! Iteratively reweighted least squares from the answer of the plain method, then Newton's steps ([`sums`]). Distances and
//! tilts are held by priors; a prior must be weighed against data that is correlated in time, so it is multiplied by
//! λ = tr(H⁻¹B)/8, the ratio of the sandwich's middle to the Hessian of the transforms: with independent residuals of
//! unit variance it is 1. H = Σ ψ'(r) J Jᵀ, B the sum over blocks of time of the outer products of their gradients (Huber
//! 1981, "Robust Statistics", section 6.3). The covariance is the [`sandwich`](crate::statistics::sandwich) with both
//! ([`mod@covariance`]).

mod answer;
mod covariance;
mod model;
mod noise;
mod sums;
mod support;

pub use self::answer::Refinement;
use self::answer::summary;
use self::covariance::covariance;
use self::model::{
    CLOCKS, CONSTANT, DISTANCES, DRIFTS, Linearised, PolarNoise, State, TILTS, UNKNOWNS, residuals,
    transforms,
};
use self::noise::{Noise, loss_scale};
use self::sums::{Sums, prior_weight, step};
pub use self::support::Support;
use crate::calibration::clocks_in_words::SUSPICIOUS_OFFSET_S;
use crate::calibration::instrument::{PRISM_CONSTANT_SIGMA_M, TILT_SIGMA_RAD};
use crate::calibration::{
    CalibrationSettings, Estimate, Estimated, Loss, MovingTriplets, time_blocks,
};
use crate::geometry::{LevelTransform, RigidTransform};
use crate::pipeline::Triplets;
use crate::progress::Progress;

const MOST_NEWTON_STEPS: usize = 30;
/// Triplets that a suspicion about the clocks rests on, spread evenly.
const SUSPICION_TRIPLETS: usize = 400;
/// Steps smaller than this (m, rad, s; all of the same order here) change nothing that anyone can see.
const SMALL_STEP: f64 = 1e-9;
/// The Trimble S7: 2 mm + 2 ppm, one arcsecond (Vaidis et al. 2022, section "Experiments").
const INSTRUMENT: PolarNoise = PolarNoise {
    range_m: 0.002,
    range_share: 2e-6,
    angle_rad: std::f64::consts::PI / 180.0 / 3600.0,
};
/// Quartz clocks drift by some parts per million (s per s, 1 σ).
const DRIFT_SIGMA: f64 = 5e-6;
/// Clocks that jump do so by milliseconds (s, 1 σ).
const JUMP_SIGMA_S: f64 = 0.01;
/// The loss's scale settles while weights are iterated; then it is held, and Newton's steps finish.
const MOST_REWEIGHTINGS: usize = 15;

/// Refines `plain`, the answer of the published method. `None` when the data leaves a direction free, or nobody waits for
/// it any more.
pub fn refine(
    triplets: &Triplets,
    plain: &[LevelTransform; 3],
    inter_prism_m: &[f64; 3],
    settings: &CalibrationSettings,
    progress: &Progress,
) -> Option<Refinement> {
    let data = MovingTriplets::all(triplets);
    let start = start(plain, inter_prism_m);
    let estimated = estimated(settings);
    let precision = precisions(settings);
    let noise = Noise::new(triplets, &plain.map(RigidTransform::from))
        .no_larger_than_residuals(&data, &start);
    let blocks = time_blocks::of(&triplets.time_s, &triplets.interval);
    let sums_at = |state: &State, scale: Option<f64>| {
        let placed = transforms(state);
        let at_state = |i: usize| Linearised::at(&data, i, state, &placed, &noise.covariance_m2[i]);
        Sums::over(&blocks, at_state, &noise, settings.loss, scale)
    };

    let mut state = start;
    let mut lambda = 0.0;
    let mut scale = None;
    let mut converged = false;
    for iteration in 0..MOST_REWEIGHTINGS + MOST_NEWTON_STEPS {
        progress.check().ok()?;
        let settled = iteration >= MOST_REWEIGHTINGS;
        let placed = transforms(&state);
        if !settled {
            let each_m = (0..triplets.len())
                .map(|index| residuals(&data, index, &state, &placed).residual_m);
            scale = loss_scale(each_m, &noise, settings.loss);
        }
        let sums = sums_at(&state, scale);
        if !settled {
            lambda = prior_weight(&sums)?;
        }
        let gradient = sums.gradient + (lambda * precision).component_mul(&(state - start));
        let newton =
            settled.then(|| step(&sums.hessian, &precision, lambda, &gradient, &estimated));
        // Reweighting always descends; Newton's step is for the end.
        let step = newton
            .flatten()
            .or_else(|| step(&sums.normal, &precision, lambda, &gradient, &estimated))?;
        state -= step;
        if step.amax() < SMALL_STEP {
            converged = true;
            break;
        }
    }
    let sums = sums_at(&state, scale);
    let covariance =
        covariance(&sums, &precision, lambda, &estimated, settings.inter_prism_sigma_m)?;
    Some(summary(&state, &start, &covariance, settings, converged))
}

/// What the clocks of stations 2 and 3 look like from the plain answer: one step of least squares with transforms, clocks
/// and distances, on some of the triplets. Cheap enough to ask of every answer. `None` when the data cannot tell, or when
/// they are too good for a suspicion, whatever their σ.
pub fn suspected_clocks(
    triplets: &Triplets,
    plain: &[LevelTransform; 3],
    inter_prism_m: &[f64; 3],
    distance_sigma_m: f64,
) -> Option<SuspectedClocks> {
    let stride = triplets.len().div_ceil(SUSPICION_TRIPLETS).max(1);
    let data = MovingTriplets::every(triplets, stride);
    let some = &data.triplets;
    let state = start(plain, inter_prism_m);
    let settings = CalibrationSettings {
        inter_prism_sigma_m: distance_sigma_m,
        estimate: Estimated { clocks: true, distances: true, tilt: false },
        ..CalibrationSettings::default()
    };
    let (places, mut precision) = (estimated(&settings), precisions(&settings));
    precision.fixed_rows_mut::<2>(DRIFTS).fill(JUMP_SIGMA_S.powi(-2));
    let noise =
        Noise::new(some, &plain.map(RigidTransform::from)).no_larger_than_residuals(&data, &state);
    let blocks = time_blocks::of(&some.time_s, &some.interval);
    let placed = transforms(&state);
    let mut each: Vec<Linearised> = (0..some.len())
        .map(|i| Linearised::at(&data, i, &state, &placed, &noise.covariance_m2[i]))
        .collect();
    // A few gross errors must not decide.
    let loss = Loss::Huber;
    let sums = |each: &[Linearised]| {
        let scale = loss_scale(each.iter().map(|triplet| triplet.residual_m), &noise, loss);
        Sums::over(&blocks, |i| &each[i], &noise, loss, scale)
    };
    let first = sums(&each);
    let lambda = prior_weight(&first)?;
    let step = -step(&first.normal, &precision, lambda, &first.gradient, &places)?;
    let state = state + step;
    let clocks = [CLOCKS, CLOCKS + 1, DRIFTS, DRIFTS + 1];
    if clocks.iter().all(|place| state[*place].abs() <= SUSPICIOUS_OFFSET_S) {
        return None;
    }
    // What the clocks explained is no error any more.
    each.iter_mut().for_each(|triplet| triplet.step(&step));
    let covariance = covariance(&sums(&each), &precision, lambda, &places, distance_sigma_m)?;
    let estimate = |place: usize| Estimate {
        value: state[place],
        sigma: covariance[(place, place)].max(0.0).sqrt(),
    };
    Some(SuspectedClocks {
        offsets_s: [CLOCKS, CLOCKS + 1].map(estimate),
        jumps_s: [DRIFTS, DRIFTS + 1].map(estimate),
    })
}

/// What the clocks of stations 2 and 3 are suspected of.
pub struct SuspectedClocks {
    pub offsets_s: [Estimate; 2],
    /// How much later they are in the second half of the drive.
    pub jumps_s: [Estimate; 2],
}

fn start(plain: &[LevelTransform; 3], inter_prism_m: &[f64; 3]) -> State {
    let mut state = State::zeros();
    for slot in 0..2 {
        let transform = &plain[slot + 1];
        state.fixed_rows_mut::<3>(4 * slot).copy_from(&transform.translation_m);
        state[4 * slot + 3] = transform.yaw_rad;
    }
    state.fixed_rows_mut::<3>(DISTANCES).copy_from_slice(inter_prism_m);
    state
}

/// Places of the unknowns that are not held.
fn estimated(settings: &CalibrationSettings) -> Vec<usize> {
    let estimate = settings.estimate;
    let groups = [
        (true, 0..CLOCKS),
        (estimate.clocks, CLOCKS..DISTANCES),
        (estimate.distances, DISTANCES..TILTS),
        (estimate.tilt, TILTS..DRIFTS),
        (estimate.clocks, DRIFTS..CONSTANT),
        (estimate.distances, CONSTANT..UNKNOWNS),
    ];
    groups.into_iter().filter(|(on, _)| *on).flat_map(|(_, places)| places).collect()
}

/// 1/σ² of the priors; zero where nothing is known beforehand.
fn precisions(settings: &CalibrationSettings) -> State {
    let mut precision = State::zeros();
    // A distance known exactly is one that is hardly estimated.
    let distance_sigma_m = settings.inter_prism_sigma_m.max(1e-6);
    precision.fixed_rows_mut::<3>(DISTANCES).fill(distance_sigma_m.powi(-2));
    precision.fixed_rows_mut::<4>(TILTS).fill(TILT_SIGMA_RAD.powi(-2));
    precision.fixed_rows_mut::<2>(DRIFTS).fill(DRIFT_SIGMA.powi(-2));
    precision[CONSTANT] = PRISM_CONSTANT_SIGMA_M.powi(-2);
    precision
}
