//! Gradients of a segment's equations alone, for steps near the solution that reuse an earlier normal matrix.

use super::PAIRS;
use super::drive::Segment;
use super::knot_grid::ORDER;
use super::residuals::{
    LinearisationPoint, NoiseLevels, ReadingResidual, distance_residual, distance_times_s,
    jerk_factors, jerk_residuals,
};
use super::state_vector::{BLOCK_DISTANCES, BlockVector};

/// Gradients of a segment's equations.
pub struct Gradients<const LOCAL: usize> {
    /// By spline coefficient, knot by knot.
    pub knots: Vec<[f64; LOCAL]>,
    /// By the unknowns of each block of the segment.
    pub blocks: Vec<BlockVector>,
}

/// Computes the gradients at a linearisation point, with robust weights in the order of the segment's equations.
pub fn gradients<const LOCAL: usize>(
    segment: &Segment,
    point: &LinearisationPoint<'_>,
    levels: &NoiseLevels,
    weights: &[f64],
) -> Gradients<LOCAL> {
    let grid = &segment.grid;
    let mut sums = Gradients {
        knots: vec![[0.0; LOCAL]; grid.knots],
        blocks: vec![BlockVector::zeros(); grid.blocks],
    };
    let mut weights = weights.iter();
    let mut next_weight = || weights.next().copied().unwrap_or(1.0);
    for (station, readings) in segment.readings.iter().enumerate() {
        for reading in readings {
            let residual = ReadingResidual::new::<LOCAL>(grid, point, levels, station, reading);
            // (20)
            let gradient =
                residual.axes * (residual.information * residual.residual_m) * next_weight();
            for (k, factor) in residual.weights.position.iter().enumerate() {
                let knot = &mut sums.knots[residual.weights.first + k];
                for axis in 0..3 {
                    knot[3 * residual.prism + axis] += factor * gradient[axis];
                }
            }
            for (column, jacobian) in residual.block_jacobian(station).into_iter().flatten() {
                sums.blocks[residual.block][column] += jacobian.dot(&gradient);
            }
        }
    }
    if let Some(distances_m) = point.distances_m {
        for time_s in distance_times_s(grid) {
            let weights = grid.weights(time_s);
            let block = &mut sums.blocks[grid.block_at(time_s)];
            for (pair, (a, b)) in PAIRS.into_iter().enumerate() {
                let (along, residual_m) =
                    distance_residual::<LOCAL>(point, &weights, (a, b), distances_m[pair]);
                let gradient = along * (residual_m * levels.distance_m.powi(-2));
                for (k, factor) in weights.position.iter().enumerate() {
                    let knot = &mut sums.knots[weights.first + k];
                    for axis in 0..3 {
                        knot[3 * a + axis] += factor * gradient[axis];
                        knot[3 * b + axis] -= factor * gradient[axis];
                    }
                }
                block[BLOCK_DISTANCES + pair] -= residual_m * levels.distance_m.powi(-2);
            }
        }
    }
    let factors = jerk_factors(grid, levels);
    for first in 0..grid.knots - (ORDER - 1) {
        let residuals = jerk_residuals::<LOCAL>(point, first, &factors);
        let weight = next_weight();
        for (k, factor) in factors.iter().enumerate() {
            for (gradient, residual) in sums.knots[first + k].iter_mut().zip(&residuals) {
                *gradient += weight * factor * residual;
            }
        }
    }
    sums
}
