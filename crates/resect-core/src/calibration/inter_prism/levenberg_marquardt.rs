//! Levenberg–Marquardt on normal equations, exact or compressed.

use super::{CentredTriplets, NormalEquations, Parameters};

/// How far from the minimum a search may end (m, and rad times the track's size): ten nanometres for the answer.
pub const FINE_M: f64 = 1e-8;
/// How far from the minimum a search may end that is only a start, or shown beside the answer: a micrometre.
pub const ROUGH_M: f64 = 1e-6;
/// Only below this step (m) is the rate of convergence a guide to what is left.
const NEAR_M: f64 = 1e-4;
const MOST_PASSES: usize = 60;

/// Where the search ended.
#[derive(Clone, Copy, Debug)]
pub struct Minimum {
    pub parameters: Parameters,
    /// The normal equations at the parameters, or a step of less than a tenth of a millimetre before them.
    pub normal: NormalEquations,
    pub converged: bool,
    /// Evaluations of the cost: passes over the data where it is the exact one.
    pub passes: usize,
}

/// Goes downhill from `start` on the exact cost to within `tolerance_m` of the nearest minimum.
pub fn minimise(data: &CentredTriplets, start: Parameters, tolerance_m: f64) -> Minimum {
    descend(|p| NormalEquations::at(data, p), track_radius_m(data), start, tolerance_m, MOST_PASSES)
}

/// Goes downhill from `start` to within `tolerance_m` of the nearest minimum of the cost that `at` gives, in at most
/// `most_passes` evaluations of it; a radian of yaw counts as `radius_m`.
///
/// Marquardt's scaling by the diagonal of JᵀJ; every pass gives cost and derivatives together, so an accepted
/// step costs one pass. Near the minimum Gauss–Newton steps shrink by a constant factor, so that two of them tell
/// how far it still is: the last step is taken without another pass once the remainder is below the tolerance.
pub fn descend(
    at: impl Fn(&Parameters) -> NormalEquations,
    radius_m: f64,
    start: Parameters,
    tolerance_m: f64,
    most_passes: usize,
) -> Minimum {
    let mut parameters = start;
    let mut normal = at(&parameters);
    let mut damping = 1e-6;
    let mut passes = 1;
    let mut converged = false;
    let mut last_step_m: Option<f64> = None;
    while passes < most_passes {
        let mut damped = normal.matrix;
        for k in 0..8 {
            let diagonal = normal.matrix[(k, k)];
            damped[(k, k)] = diagonal * (1.0 + damping) + 1e-12 * normal.matrix.trace();
        }
        let Some(cholesky) = damped.cholesky() else {
            damping = (damping * 10.0).max(1e-6);
            if damping > 1e12 {
                break;
            }
            continue;
        };
        let step = -cholesky.solve(&normal.gradient);
        let step_size_m = (0..8)
            .map(|k| if k % 4 == 3 { step[k].abs() * radius_m } else { step[k].abs() })
            .fold(0.0, f64::max);
        if !step_size_m.is_finite() {
            break;
        }
        let left_m = match last_step_m {
            Some(last) if step_size_m < NEAR_M && step_size_m < 0.1 * last => {
                step_size_m * step_size_m / last
            }
            _ => step_size_m,
        };
        if left_m < tolerance_m {
            parameters += step;
            converged = true;
            break;
        }
        let trial = parameters + step;
        let next = at(&trial);
        passes += 1;
        if next.cost <= normal.cost {
            let change = normal.cost - next.cost;
            parameters = trial;
            normal = next;
            last_step_m = Some(step_size_m);
            damping = (damping * 0.1).max(1e-9);
            if change <= 1e-15 * normal.cost {
                converged = true;
                break;
            }
        } else {
            // Rounding hides any further descent.
            if next.cost - normal.cost <= 1e-14 * normal.cost {
                converged = true;
                break;
            }
            damping *= 10.0;
            if damping > 1e12 {
                break;
            }
        }
    }
    for yaw in [3, 7] {
        parameters[yaw] = crate::geometry::wrap_to_pi(parameters[yaw]);
    }
    Minimum { parameters, normal, converged, passes }
}

/// Root mean square horizontal distance of the points from their centroid (m), 1 at least: what a radian of yaw
/// moves.
pub fn track_radius_m(data: &CentredTriplets) -> f64 {
    let [x, y, _] = &data.coordinates[1];
    let sum: f64 = x.iter().zip(y).map(|(x, y)| x * x + y * y).sum();
    (sum / data.len().max(1) as f64).sqrt().max(1.0)
}
