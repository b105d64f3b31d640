//! The clock check of method D: one Gauss–Newton step from the answer.
//!
//! Distances, jumps and the prism constant have priors. Residuals are correlated in time, so each prior is multiplied by λ =
//! tr(H⁻¹B)/8. This is the ratio of the sandwich's middle to the Hessian of the transforms: 1 for independent residuals of unit
//! variance. H is Σ ψ'(r) J Jᵀ, and B is the sum over blocks of time of the outer products of their gradients (Huber 1981, "Robust
//! Statistics", section 6.3).

use super::covariance::covariance;
use super::model::{
    CLOCKS, CONSTANT, DISTANCES, JUMPS, Linearised, State, TILTS, UNKNOWNS, transforms,
};
use super::noise::{SeparationCovariances, huber_bend};
use super::sums::{ClockCheckSums, prior_weight, step};
use crate::calibration::clocks_in_words::SUSPICIOUS_OFFSET_S;
use crate::calibration::instrument::PRISM_CONSTANT_SIGMA_M;
use crate::calibration::{Estimate, MovingTriplets, time_blocks};
use crate::geometry::{LevelTransform, RigidTransform};
use crate::pipeline::Triplets;

/// Triplets that the check uses, spread evenly.
const CHECKED_TRIPLETS: usize = 400;
/// σ of the prior of a clock jump (s).
const JUMP_SIGMA_S: f64 = 0.01;
/// The smallest σ of a distance (m): a prior of zero width has no precision.
const LEAST_DISTANCE_SIGMA_M: f64 = 1e-6;

/// Clock offsets of stations 2 and 3, which method D does not estimate.
pub struct SuspectedClocks {
    pub offsets_s: [Estimate; 2],
    /// Offset in the second half of the drive minus that in the first (s).
    pub jumps_s: [Estimate; 2],
}

/// Estimates the clocks of stations 2 and 3 by one least-squares step from the answer `plain`, on some of the triplets.
///
/// `None` if the data does not determine them, or if all offsets and jumps are negligible.
pub fn suspected_clocks(
    triplets: &Triplets,
    plain: &[LevelTransform; 3],
    inter_prism_m: &[f64; 3],
    distance_sigma_m: f64,
) -> Option<SuspectedClocks> {
    let stride = triplets.len().div_ceil(CHECKED_TRIPLETS).max(1);
    let data = MovingTriplets::every(triplets, stride);
    let some = &data.triplets;
    let state = start(plain, inter_prism_m);
    let precision = precisions(distance_sigma_m);
    // Tilts are constrained: their σ only widens the covariance.
    let places: Vec<usize> = (0..TILTS).chain(JUMPS..UNKNOWNS).collect();
    let noise = SeparationCovariances::new(some, &plain.map(RigidTransform::from))
        .no_larger_than_residuals(&data, &state);
    let blocks = time_blocks::of(&some.time_s, &some.interval);
    let placed = transforms(&state);
    let mut each: Vec<Linearised> = (0..some.len())
        .map(|i| Linearised::at(&data, i, &state, &placed, &noise.covariance_m2[i]))
        .collect();
    let sums = |each: &[Linearised]| ClockCheckSums::over(&blocks, each, huber_bend(each));
    let first = sums(&each);
    let lambda = prior_weight(&first)?;
    let step = -step(&first.normal, &precision, lambda, &first.gradient, &places)?;
    let state = state + step;
    let clocks = [CLOCKS, CLOCKS + 1, JUMPS, JUMPS + 1];
    if clocks.iter().all(|place| state[*place].abs() <= SUSPICIOUS_OFFSET_S) {
        return None;
    }
    // Residuals after the step, without the effect of the clocks.
    each.iter_mut().for_each(|triplet| triplet.step(&step));
    let covariance = covariance(&sums(&each), &precision, lambda, &places)?;
    let estimate = |place: usize| Estimate {
        value: state[place],
        sigma: covariance[(place, place)].max(0.0).sqrt(),
    };
    Some(SuspectedClocks {
        offsets_s: [CLOCKS, CLOCKS + 1].map(estimate),
        jumps_s: [JUMPS, JUMPS + 1].map(estimate),
    })
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

/// Precisions (1/σ²) of the priors; zero for an unknown without a prior.
fn precisions(distance_sigma_m: f64) -> State {
    let mut precision = State::zeros();
    let distance_sigma_m = distance_sigma_m.max(LEAST_DISTANCE_SIGMA_M);
    precision.fixed_rows_mut::<3>(DISTANCES).fill(distance_sigma_m.powi(-2));
    precision.fixed_rows_mut::<2>(JUMPS).fill(JUMP_SIGMA_S.powi(-2));
    precision[CONSTANT] = PRISM_CONSTANT_SIGMA_M.powi(-2);
    precision
}
