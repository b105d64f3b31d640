//! Levenberg–Marquardt on normal equations, exact or compressed.

use super::{CentredTriplets, NormalEquations, Parameters};

/// Tolerance of the answer (m, and rad times the radius of the track): ten nanometres.
pub const FINE_M: f64 = 1e-8;
/// Tolerance of a starting point, and of a minimum that is only shown beside the answer: a micrometre.
pub const ROUGH_M: f64 = 1e-6;
/// Step below which the rate of convergence predicts the remaining distance (m).
const NEAR_M: f64 = 1e-4;
/// Most passes of a minimisation.
const MOST_PASSES: usize = 60;

/// End point of a descent.
#[derive(Clone, Copy, Debug)]
pub struct Minimum {
    pub parameters: Parameters,
    /// Normal equations at the parameters, or at less than a tenth of a millimetre from them.
    pub normal: NormalEquations,
    pub converged: bool,
    /// Number of evaluations of the cost: passes over the data for the exact cost.
    pub passes: usize,
}

/// Minimises the exact cost from `start`, to within `tolerance_m` of the nearest minimum.
pub fn minimise(data: &CentredTriplets, start: Parameters, tolerance_m: f64) -> Minimum {
    descend(|p| NormalEquations::at(data, p), track_radius_m(data), start, tolerance_m, MOST_PASSES)
}

/// Minimises the cost that `at` evaluates from `start`, to within `tolerance_m` of the nearest minimum, in at most `most_passes`
/// evaluations. A radian of yaw counts as `radius_m`.
///
/// The damping is Marquardt's, by the diagonal of JᵀJ. Every pass computes cost and derivatives together, so an accepted step costs
/// one pass. Near the minimum Gauss–Newton steps shrink by a constant factor, so two steps predict the remaining distance. Once
/// that is below the tolerance, the last step is applied without another pass.
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
            // Rounding errors exceed any further descent.
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

/// Returns the displacement by a radian of yaw: the root mean square horizontal distance of the points from their centroid, at
/// least 1 (m).
pub fn track_radius_m(data: &CentredTriplets) -> f64 {
    let [x, y, _] = &data.coordinates[1];
    let sum: f64 = x.iter().zip(y).map(|(x, y)| x * x + y * y).sum();
    (sum / data.len().max(1) as f64).sqrt().max(1.0)
}
