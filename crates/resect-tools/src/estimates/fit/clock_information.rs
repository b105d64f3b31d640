//! Covariance of the unknowns without the noise of velocities.
//!
//! The information on the clock is a sum over squares of velocities, and noise of the positions is in each. It looks like motion: on a smooth
//! drive σ of the time offset would be several times too small. The velocities of the other trajectory have another noise, so the product of both
//! is the motion that there is. With the information I by one of them, its part A by both, and the gradient's covariance I, the unknowns
//! have the covariance A⁻¹ I A⁻ᵀ (Huber 1967).

use nalgebra::DMatrix;

use super::drift_sizes::DriftSizes;
use super::likelihood::Equations;
use super::state::FitState;
use super::unknowns::CLOCK;
use super::wandering_frame::clock_by_both_motions;
use crate::estimates::matched_pose::MatchedPose;

/// Returns the covariance of the open unknowns; `None` if the drive does not determine them.
pub fn covariance(
    equations: &Equations,
    pairs: &[MatchedPose],
    (state, sizes): (&FitState, &DriftSizes),
    open: &[usize],
) -> Option<DMatrix<f64>> {
    let information = &equations.information;
    let by_one = information.clone().cholesky()?.inverse();
    let Some(clock) = open.iter().position(|unknown| *unknown == CLOCK) else {
        return Some(by_one);
    };
    let by_both = clock_by_both_motions(pairs, state, sizes);
    let by_both = by_both.select_rows(&equations.instruments.columns);
    let mut column = &equations.transform * by_both;
    column[clock] += equations.prior[clock];
    let mut slopes = information.clone();
    slopes.set_column(clock, &column);
    let inverse = slopes.try_inverse()?;
    let by_both = &inverse * information * inverse.transpose();
    // Beyond the information by one of them there is only noise.
    Some(if by_both[(clock, clock)] > by_one[(clock, clock)] { by_both } else { by_one })
}
