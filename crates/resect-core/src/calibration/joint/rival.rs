//! Comparison of an estimate with its rival from another start, by the likelihoods of all readings.

use super::attempt_end::AttemptEnd;
use super::constants_prior::prior_mean;
use super::estimate::{Iteration, MOST_ITERATIONS};
use super::gauss_newton_step::RowBuffers;
use super::joint_estimate::JointEstimate;
use super::linearisation::Weighting;
use super::priors::independent_share;
use super::prism_motion::Solution;
use super::solver_status::SolverStatus;
use super::state_vector::{Constants, StateVector};
use super::trace::Trace;
use super::unknown::DISTANCE;
use crate::geometry::{LevelTransform, wrap_to_pi};
use crate::network::PerStation;
use crate::progress::{Cancelled, Progress};

/// A minimum is reached once a step lowers its cost by less (σ²).
const SMALL_FALL: f64 = 0.5;
/// Least difference of costs that decides (σ²): five σ.
const DECISIVE: f64 = 25.0;
/// Part of it by each independent error of the facets (σ²).
/// Simulated: with errors of prior size at 2.5 and 10 Hz, the wrong of two twins is likelier by up to 0.3 on 80 flat floors. In tunnels the right one is by
/// 0.7 in the median.
const DECISIVE_OF_FACETS: f64 = 0.3;

/// Returns the difference of costs from which the likelihoods decide (σ²).
pub fn decisive_excess(estimate: &JointEstimate) -> f64 {
    // (26)
    let drive = &estimate.solution.drive;
    DECISIVE + DECISIVE_OF_FACETS * drive.knots() as f64 * independent_share(drive.knot_s())
}

/// Returns the cost (14) of the rival that the iteration reaches from other poses beyond that of the estimate (σ²): −2 ln of the ratio of
/// their likelihoods. It is infinite if the iteration returns to the estimate, and `None` if it fails.
///
/// Both costs have the noise levels and the priors of the estimate, and robust weights of their own.
pub fn excess_of(
    estimate: &JointEstimate,
    start: &PerStation<LevelTransform>,
    progress: &Progress,
) -> Result<Option<f64>, Cancelled> {
    let solution = &estimate.solution;
    let (own_start, rival_start) = (&solution.state.constants, constants_at(solution, start));
    let minimum_from = |state: StateVector| match minimum(solution, state, progress) {
        Ok(minimum) => Ok(Some(minimum)),
        Err(AttemptEnd::Cancelled) => Err(Cancelled),
        Err(AttemptEnd::Failed(_)) => Ok(None),
    };
    let Some((_, own_cost)) = minimum_from(solution.state.clone())? else { return Ok(None) };
    let there = minimum_from(solution.drive.initial_state(&rival_start))?;
    let poses = solution.layout().poses();
    Ok(there.map(|(constants, cost)| {
        let apart = |from: &Constants| (&constants - from).rows(0, poses).norm();
        let is_own = apart(own_start) < apart(&rival_start);
        if is_own { f64::INFINITY } else { cost - own_cost }
    }))
}

/// Returns the constants of a solution with other poses, whose yaws are near its own.
fn constants_at(solution: &Solution, poses: &PerStation<LevelTransform>) -> Constants {
    let (layout, estimated) = (solution.layout(), &solution.state.constants);
    let distances_m = layout.indices(&DISTANCE).map(|index| estimated[index]).collect();
    let other = prior_mean(layout, poses, &distances_m);
    let mut constants = estimated.clone();
    for index in 0..layout.poses() {
        let is_yaw = index % 4 == 3;
        let change = other[index] - estimated[index];
        constants[index] += if is_yaw { wrap_to_pi(change) } else { change };
    }
    constants
}

/// Returns the constants and the cost of the minimum near a state.
fn minimum(
    solution: &Solution,
    state: StateVector,
    progress: &Progress,
) -> Result<(Constants, f64), AttemptEnd> {
    let mut trace = Trace::default();
    let mut iteration = Iteration {
        drive: solution.drive.clone(),
        sizes: &solution.sizes,
        progress,
        priors: solution.priors.clone(),
        weighting: Weighting { fixed: None, ..solution.weighting.clone() },
        state,
        steps: Vec::new(),
        buffers: RowBuffers::default(),
        iterations: 0,
        before: None,
        pending_survey: None,
        trace: &mut trace,
    };
    let mut least = f64::INFINITY;
    loop {
        let step = iteration.linearise()?;
        if step.is_stiffer {
            return Err(SolverStatus::StifferPriors.into());
        }
        let cost = step.cost(&iteration.state, &iteration.priors);
        if least - cost < SMALL_FALL {
            return Ok((iteration.state.constants, cost.min(least)));
        }
        if iteration.iterations >= MOST_ITERATIONS {
            return Err(SolverStatus::TooManySteps.into());
        }
        least = cost;
        iteration.apply(&step, |_| ())?;
        iteration.buffers = step.into_buffers();
    }
}
