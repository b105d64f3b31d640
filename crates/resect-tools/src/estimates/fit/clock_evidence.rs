//! Evidence of a clock that changes during the drive, by the likelihood of the errors.

use super::clock_change::{ClockChange, LEAST_S, candidates};
use super::drift_sizes::DriftSizes;
use super::likelihood::Equations;
use super::state::FitState;
use super::wandering_frame::pass;
use crate::estimates::association::thinned;
use crate::estimates::matched_pose::MatchedPose;

/// Least cost of a constant clock by which it is said to change.
/// Effect: a smaller one takes lasting errors along the motion for wander. Textbook: χ² of 2 exceeds 20 once in 20,000.
const DECISIVE_COST: f64 = 20.0;
/// Least cost that a step or a drift saves.
/// Effect: a smaller one takes drift along the motion for a step, in 2 of 120 simulated odometries with 20.
const DECISIVE_CHANGE: f64 = 60.0;
/// Least share of that cost which a single step or a drift explains.
/// Effect: a smaller share takes wander for a step. A random walk of the clock leaves about half of its cost.
const LEAST_EXPLAINED: f64 = 0.8;
/// Smallest wander that is said (s).
/// Field: links without synchronisation wander by some hundredths, and one time offset is their mean.
const LEAST_WANDER_S: f64 = 0.05;
/// Longest time within which jitter changes (s).
/// Effect: a slower one cannot be told from lasting errors along the motion. Field: jitter of stamps changes from reading to reading.
const LONGEST_JITTER_S: f64 = 2.0;

/// Largest number of epochs by which changes are compared, evenly spread.
const MOST_COMPARED: usize = 3000;

/// Returns the change of the clock that the errors show; `None` if it is constant. `filtered_cost` is that of a pass with all sizes.
pub fn significant_clock_change(
    filtered_cost: f64,
    pairs: &[MatchedPose],
    state: &FitState,
    sizes: &DriftSizes,
    open: &[usize],
) -> Option<ClockChange> {
    // The other sizes stay: with their own best ones, the cost without wander would be smaller.
    let constant = DriftSizes { clock_s: 1e-5, slow_clock_s: 1e-5, ..*sizes };
    let cost = |pairs: &[MatchedPose]| {
        let without = pass(pairs, state, &constant, None);
        let Equations { information, gradient, .. } = Equations::of(&without, state, open);
        // The unknowns follow: their offset is another one without wander.
        let gain = information.cholesky().map_or(0.0, |root| gradient.dot(&root.solve(&gradient)));
        without.cost - gain
    };
    if cost(pairs) - filtered_cost < DECISIVE_COST {
        return None;
    }
    let sample: Vec<MatchedPose> = thinned(pairs, MOST_COMPARED).cloned().collect();
    let constant_cost = cost(&sample);
    let excess = constant_cost - pass(&sample, state, sizes, None).cost;
    // A clock that returns to its mean would show a step too small.
    let followed = pass(pairs, state, &sizes.with_walking_clock(), None).clock;
    let cost_of = |change: &ClockChange| cost(&change.applied(&sample));
    let best = candidates(&followed)
        .into_iter()
        .map(|change| best_near(change, constant_cost, &cost_of))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let duration_s = pairs[pairs.len() - 1].truth.time_s - pairs[0].truth.time_s;
    let is_said = |(change, cost): &(ClockChange, f64)| {
        let saved = constant_cost - cost;
        saved > DECISIVE_CHANGE.max(LEAST_EXPLAINED * excess) && change.size_s(duration_s) > LEAST_S
    };
    let is_jitter = sizes.clock_s > LEAST_S && sizes.clock_time_s < LONGEST_JITTER_S;
    let jitter = is_jitter.then_some(ClockChange::Jitter { sigma_s: sizes.clock_s });
    let wander = || {
        let sigma_s = sizes.slow_clock_s;
        (sigma_s > LEAST_WANDER_S).then_some(ClockChange::Wander { sigma_s })
    };
    best.filter(is_said).map(|(change, _)| change).or_else(wander).or(jitter)
}

/// Times by which a step is moved to the place where it costs least (s).
const LATER_S: [f64; 3] = [4.0, 2.0, 0.5];
const MOST_MOVES: usize = 6;

/// Returns the change near a first one that costs least, and its cost: the filter follows a step late, and a drift in part.
fn best_near(
    first: ClockChange,
    constant_cost: f64,
    cost_of: &dyn Fn(&ClockChange) -> f64,
) -> (ClockChange, f64) {
    let mut best = (first, cost_of(&first));
    for later_s in LATER_S {
        for signed_s in [later_s, -later_s] {
            for _ in 0..MOST_MOVES {
                let moved = best.0.later(signed_s);
                let cost = if moved == best.0 { f64::INFINITY } else { cost_of(&moved) };
                if cost >= best.1 {
                    break;
                }
                best = (moved, cost);
            }
        }
        // The parabola through the costs without the change, with it, and with twice of it.
        let twice = cost_of(&best.0.scaled(2.0));
        let curvature = twice - 2.0 * best.1 + constant_cost;
        let slope = 2.0 * best.1 - 1.5 * constant_cost - 0.5 * twice;
        let scaled = best.0.scaled((-slope / curvature).clamp(0.5, 3.0));
        let cost = cost_of(&scaled);
        if curvature > 0.0 && cost < best.1 {
            best = (scaled, cost);
        }
    }
    best
}
