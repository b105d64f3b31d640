//! Levenberg–Marquardt on normal equations, exact or compressed.

use nalgebra::DMatrix;

use super::prism_network::UNKNOWNS_PER_STATION;
use super::{CentredTriplets, NormalEquations, Parameters};
use crate::geometry::wrap_to_pi;
use crate::network::{Number, Station};

/// Tolerance of the answer (m, and rad times the radius of the track): ten nanometres.
pub const FINE_M: f64 = 1e-8;
/// Tolerance of a starting point, and of a minimum that is only shown beside the answer: a micrometre.
pub const ROUGH_M: f64 = 1e-6;
/// Step below which the rate of convergence predicts the remaining distance (m).
const NEAR_M: f64 = 1e-4;
/// Most passes of a minimisation.
const MOST_PASSES: usize = 60;

/// End point of a descent.
#[derive(Clone, Debug)]
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
    let evaluate = |p: &Parameters, normal: &mut NormalEquations| {
        normal.evaluate(data, p, 0..data.len());
    };
    descend(evaluate, track_radius_m(data), start, tolerance_m, MOST_PASSES)
}

/// Minimises the cost that `evaluate` computes from `start`, to within `tolerance_m` of the nearest minimum, in at most `most_passes`
/// evaluations. A radian of yaw counts as `radius_m`.
///
/// The damping is Marquardt's, by the diagonal of JᵀJ. Every pass computes cost and derivatives together, so an accepted step costs
/// one pass. Near the minimum Gauss–Newton steps shrink by a constant factor, so two steps predict the remaining distance. Once
/// that is below the tolerance, the last step is applied without another pass.
pub fn descend(
    evaluate: impl Fn(&Parameters, &mut NormalEquations),
    radius_m: f64,
    start: Parameters,
    tolerance_m: f64,
    most_passes: usize,
) -> Minimum {
    let unknowns = start.len();
    let mut parameters = start;
    let [mut normal, mut next] = [0, 1].map(|_| NormalEquations::zeros(unknowns));
    let (mut step, mut trial) = (Parameters::zeros(unknowns), Parameters::zeros(unknowns));
    let mut damped = DMatrix::zeros(unknowns, unknowns);
    evaluate(&parameters, &mut normal);
    let mut damping = 1e-6;
    let mut passes = 1;
    let mut converged = false;
    let mut last_step_m: Option<f64> = None;
    while passes < most_passes {
        damp(&normal.matrix, damping, &mut damped);
        if !solve(&mut damped, &normal.gradient, &mut step) {
            damping = (damping * 10.0).max(1e-6);
            if damping > 1e12 {
                break;
            }
            continue;
        }
        let step_size_m = size_m(&step, radius_m);
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
            parameters += &step;
            converged = true;
            break;
        }
        parameters.add_to(&step, &mut trial);
        evaluate(&trial, &mut next);
        passes += 1;
        if next.cost <= normal.cost {
            let change = normal.cost - next.cost;
            std::mem::swap(&mut parameters, &mut trial);
            std::mem::swap(&mut normal, &mut next);
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
    for yaw in parameters.iter_mut().skip(3).step_by(UNKNOWNS_PER_STATION) {
        *yaw = wrap_to_pi(*yaw);
    }
    Minimum { parameters, normal, converged, passes }
}

/// Writes JᵀJ with Marquardt's damping to `damped`.
fn damp(matrix: &DMatrix<f64>, damping: f64, damped: &mut DMatrix<f64>) {
    damped.copy_from(matrix);
    let least = 1e-12 * matrix.trace();
    for k in 0..matrix.nrows() {
        damped[(k, k)] = matrix[(k, k)] * (1.0 + damping) + least;
    }
}

/// Writes the Gauss–Newton step to `step`, and overwrites the matrix by its Cholesky factor. Returns false if it is not positive
/// definite.
///
/// For the few unknowns of a network this is twice as fast as nalgebra's matrices of dynamic size.
fn solve(matrix: &mut DMatrix<f64>, gradient: &Parameters, step: &mut Parameters) -> bool {
    let order = gradient.len();
    let columns = matrix.as_mut_slice();
    for j in 0..order {
        let (done, rest) = columns.split_at_mut(j * order);
        let column = &mut rest[j..order];
        for other in done.chunks_exact(order) {
            let other = &other[j..];
            let factor = other[0];
            for (entry, other) in column.iter_mut().zip(other) {
                *entry -= factor * other;
            }
        }
        let diagonal = column[0].sqrt();
        if diagonal.is_nan() || diagonal <= 0.0 {
            return false;
        }
        column.iter_mut().for_each(|entry| *entry /= diagonal);
    }
    let step = step.as_mut_slice();
    for (step, gradient) in step.iter_mut().zip(gradient) {
        *step = -gradient;
    }
    for (j, column) in columns.chunks_exact(order).enumerate() {
        step[j] /= column[j];
        let value = step[j];
        for (rest, factor) in step[j + 1..].iter_mut().zip(&column[j + 1..]) {
            *rest -= value * factor;
        }
    }
    for (j, column) in columns.chunks_exact(order).enumerate().rev() {
        let below = step[j + 1..].iter().zip(&column[j + 1..]);
        let known: f64 = below.map(|(value, factor)| value * factor).sum();
        step[j] = (step[j] - known) / column[j];
    }
    true
}

/// Returns the largest component of a step (m); a radian of yaw counts as `radius_m`.
fn size_m(step: &Parameters, radius_m: f64) -> f64 {
    step.as_slice().chunks_exact(UNKNOWNS_PER_STATION).fold(0.0, |size_m: f64, p| {
        [p[0].abs(), p[1].abs(), p[2].abs(), p[3].abs() * radius_m]
            .into_iter()
            .fold(size_m, f64::max)
    })
}

/// Returns the displacement by a radian of yaw: the root mean square horizontal distance of the points from their centroid, at
/// least 1 (m).
pub fn track_radius_m(data: &CentredTriplets) -> f64 {
    let [x, y, _] = &data.coordinates[Station::at(1)];
    let sum: f64 = x.iter().zip(y).map(|(x, y)| x * x + y * y).sum();
    (sum / data.len().max(1) as f64).sqrt().max(1.0)
}

#[cfg(test)]
mod tests {
    use super::super::distance_pass::tests::{irregular, irregular_shared};
    use super::*;

    #[test]
    fn the_step_is_that_of_nalgebra() {
        for (data, parameters) in [irregular(40), irregular_shared(40)] {
            let normal = NormalEquations::at(&data, &parameters);
            let expected =
                normal.matrix.clone().cholesky().expect("definite").solve(&normal.gradient);
            let mut step = Parameters::zeros(parameters.len());
            assert!(solve(&mut normal.matrix.clone(), &normal.gradient, &mut step));
            assert!((step + &expected).amax() < 1e-9 * expected.amax());
            let mut indefinite = normal.matrix;
            indefinite[(5, 5)] = -1.0;
            assert!(!solve(
                &mut indefinite,
                &normal.gradient,
                &mut Parameters::zeros(parameters.len())
            ));
        }
    }
}
