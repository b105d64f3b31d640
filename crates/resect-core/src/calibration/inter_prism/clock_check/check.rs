//! The clock check of method D: one Gauss–Newton step from the answer.
//!
//! Distances, jumps and the prism constant have priors. Residuals are correlated in time, so each prior is multiplied by λ =
//! tr(H⁻¹B)/n of the n unknowns of the transforms. This is the ratio of the sandwich's middle to the Hessian of the transforms: 1 for independent residuals of unit
//! variance. H is Σ ψ'(r) J Jᵀ, and B is the sum over blocks of time of the outer products of their gradients (Huber 1981, "Robust
//! Statistics", section 6.3).

use super::covariance::covariance;
use super::model::{ClockCheckModel, LinearisedTriplets, State};
use super::noise::{SeparationCovariances, huber_bend};
use super::sums::{ClockCheckSums, prior_weight, step};
use crate::calibration::clocks_in_words::SUSPICIOUS_OFFSET_S;
use crate::calibration::instrument::PRISM_CONSTANT_SIGMA_M;
use crate::calibration::inter_prism::PrismNetwork;
use crate::calibration::inter_prism::prism_network::first_unknown;
use crate::calibration::{Estimate, MovingTriplets, time_blocks};
use crate::geometry::{LevelTransform, RigidTransform};
use crate::network::{PerStation, Station};
use crate::pipeline::Triplets;

/// Triplets that the check uses, spread evenly.
const CHECKED_TRIPLETS: usize = 400;
/// σ of the prior of a clock jump (s).
const JUMP_SIGMA_S: f64 = 0.01;
/// The smallest σ of a distance (m): a prior of zero width has no precision.
const LEAST_DISTANCE_SIGMA_M: f64 = 1e-6;

/// Clock offsets from station 1, which method D does not estimate; zero of station 1.
pub struct SuspectedClocks {
    pub offsets_s: PerStation<Estimate>,
    /// Offset in the second half of the drive minus that in the first (s).
    pub jumps_s: PerStation<Estimate>,
}

/// Estimates the clocks of all stations but the first by one least-squares step from the answer `plain`, on some of the triplets.
///
/// `None` if the data does not determine them, or if all offsets and jumps are negligible.
pub fn suspected_clocks(
    triplets: &Triplets,
    plain: &PerStation<LevelTransform>,
    network: &PrismNetwork,
    distance_sigma_m: f64,
) -> Option<SuspectedClocks> {
    let stride = triplets.len().div_ceil(CHECKED_TRIPLETS).max(1);
    let data = MovingTriplets::every(triplets, stride);
    let some = &data.triplets;
    let model = ClockCheckModel::new(network);
    let state = start(&model, plain);
    let precision = precisions(&model, distance_sigma_m);
    let places = model.estimated();
    let placed = plain.map(|level| RigidTransform::from(*level));
    let noise = SeparationCovariances::new(network, some, &placed)
        .no_larger_than_residuals(&model, &data, &state);
    let blocks = time_blocks::of(&some.time_s, &some.interval);
    let mut linearised = LinearisedTriplets::at(&model, &data, &state, &noise.covariance_m2);
    let sums = |linearised: &LinearisedTriplets| {
        ClockCheckSums::over(&blocks, linearised, huber_bend(linearised))
    };
    let first = sums(&linearised);
    let lambda = prior_weight(&model, &first)?;
    let step = -step(&first.normal, &precision, lambda, &first.gradient, &places)?;
    let state = state + &step;
    let mut clocks = model.clocks().chain(model.jumps());
    if clocks.all(|place| state[place].abs() <= SUSPICIOUS_OFFSET_S) {
        return None;
    }
    // Residuals after the step, without the effect of the clocks.
    linearised.step(&step);
    let covariance = covariance(&model, &sums(&linearised), &precision, lambda, &places)?;
    let estimate = |first: usize, station: Station| {
        station.slot().map_or(Estimate { value: 0.0, sigma: 0.0 }, |slot| {
            let place = first + slot;
            Estimate { value: state[place], sigma: covariance[(place, place)].max(0.0).sqrt() }
        })
    };
    Some(SuspectedClocks {
        offsets_s: plain.map_each(|station, _| estimate(model.clocks().start, station)),
        jumps_s: plain.map_each(|station, _| estimate(model.jumps().start, station)),
    })
}

fn start(model: &ClockCheckModel, plain: &PerStation<LevelTransform>) -> State {
    let mut state = State::zeros(model.order());
    for (station, transform) in plain.each() {
        if let Some(first) = first_unknown(station) {
            state.fixed_rows_mut::<3>(first).copy_from(&transform.translation_m);
            state[first + 3] = transform.yaw_rad;
        }
    }
    for (place, (_, distance_m)) in model.distances().zip(&model.distances_m) {
        state[place] = *distance_m;
    }
    state
}

/// Precisions (1/σ²) of the priors; zero for an unknown without a prior.
fn precisions(model: &ClockCheckModel, distance_sigma_m: f64) -> State {
    let mut precision = State::zeros(model.order());
    let distance_sigma_m = distance_sigma_m.max(LEAST_DISTANCE_SIGMA_M);
    model.distances().for_each(|place| precision[place] = distance_sigma_m.powi(-2));
    model.jumps().for_each(|place| precision[place] = JUMP_SIGMA_S.powi(-2));
    precision[model.constant()] = PRISM_CONSTANT_SIGMA_M.powi(-2);
    precision
}
