//! Control of the Gauss–Newton steps: the share of a step that is taken, and the step with which the iteration has converged.

use super::gauss_newton_step::GaussNewtonStep;
use super::state_vector::Constants;

/// Share of a step after one that went too far.
const OVERSHOT: f64 = 0.5;
/// Steps that shrink more slowly than by this factor are shortened if they turn back, or else extrapolated.
const SLOW: f64 = 0.6;
/// Least cosine of the angle between steps in one direction, and between opposite ones.
const ONE_DIRECTION: f64 = 0.8;
/// Largest multiple of a step that is taken.
const LONGEST: f64 = 10.0;
/// The iteration has converged once the squared length of a step is this small (σ²).
const CONVERGED: f64 = 4e-3;
/// Blocks that may share this squared length. On longer drives no constant moves by more than its root, either.
const CONVERGED_BLOCKS: f64 = 100.0;
/// After this many steps, a longer step is small enough.
/// Simulated: of 500 drives, one goes back and forth between two motions of a prism that no station sees.
const PATIENT: usize = 25;
/// The squared length of such a step (σ²): a third of σ, of all constants together.
const CONVERGED_AT_LAST: f64 = 0.1;

/// Returns true for a step with which the iteration has converged, after so many steps.
pub fn is_small(step: &GaussNewtonStep, iterations: usize) -> bool {
    let square = if iterations < PATIENT { CONVERGED } else { CONVERGED_AT_LAST };
    let times = step.step.slow.len() as f64 / CONVERGED_BLOCKS;
    // (21)
    step.squared_length < square
        || step.squared_length < square * times && step.largest_step_sigmas().powi(2) < square
}

/// Returns the share of a step (σ) after another one, of which this share was taken.
///
/// With fixed weights each error shrinks from step to step by the factor of its direction, so that the slowest remains. If it is negative, the
/// last step went too far, and the next one, as long, would return. Otherwise the sum of all further steps is known (Aitken 1926).
pub fn share_after(before: &Constants, share: f64, step: &Constants, is_fixed: bool) -> f64 {
    let factor = step.norm() / before.norm();
    let cosine = step.dot(before) / (step.norm() * before.norm());
    if is_fixed && factor > SLOW && cosine < -ONE_DIRECTION {
        return OVERSHOT * share.min(1.0);
    }
    let is_slow = is_fixed && share == 1.0 && (SLOW..1.0).contains(&factor);
    if is_slow && cosine > ONE_DIRECTION {
        return (1.0 - factor).recip().min(LONGEST);
    }
    (2.0 * share).min(1.0)
}
