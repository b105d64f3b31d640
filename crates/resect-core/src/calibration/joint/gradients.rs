//! Gradients of a segment's equations alone, for steps near the solution that reuse an earlier normal matrix.

use nalgebra::Vector3;

use super::drive::Segment;
use super::knot_grid::KnotGrid;
use super::residuals::{
    BlockColumns, LinearisationPoint, NoiseLevels, ReadingResidual, distance_residual,
    distance_times_s, jerk_factors, jerk_precisions, jerk_residuals,
};
use super::state_vector::{BlockVector, Layout};

/// Gradients of a segment's equations.
#[derive(Clone)]
pub struct Gradients {
    /// By spline coefficient, knot by knot.
    pub knots: Vec<f64>,
    /// By the unknowns of each block of the segment.
    pub blocks: Vec<BlockVector>,
}

/// Computes the gradients at a linearisation point, with robust weights in the order of the segment's equations.
pub fn gradients(
    segment: &Segment,
    point: &LinearisationPoint<'_>,
    levels: &NoiseLevels,
    weights: &[f64],
) -> Gradients {
    let (grid, layout) = (&segment.grid, point.layout);
    let local = point.prisms.coordinates();
    let mut sums = Gradients::zeros(segment, layout);
    let mut weights = weights.iter();
    let mut next_weight = || weights.next().copied().unwrap_or(1.0);
    for (station, readings) in segment.readings.each() {
        for reading in readings.iter() {
            let residual = ReadingResidual::new(grid, point, levels, station, reading);
            // (20)
            let gradient =
                residual.axes * (residual.information * residual.residual_m) * next_weight();
            sums.add(&residual, &residual.block_jacobian(layout, station), &gradient, local);
        }
    }
    if !point.prisms.pairs.is_empty() {
        sums.add_distances(grid, point, levels);
    }
    let (mut residuals, mut precisions) = (vec![0.0; local], vec![0.0; local]);
    let factors = jerk_factors(grid);
    for (first, excess) in segment.excess_jerks.iter().enumerate() {
        jerk_precisions(levels, excess, &mut precisions);
        jerk_residuals(point, first, &factors, &mut residuals);
        let weight = next_weight();
        for (residual, precision) in residuals.iter_mut().zip(&precisions) {
            *residual *= weight * precision;
        }
        for (knot, factor) in sums.knots[local * first..].chunks_exact_mut(local).zip(&factors) {
            for (gradient, residual) in knot.iter_mut().zip(&residuals) {
                *gradient += factor * residual;
            }
        }
    }
    sums
}

impl Gradients {
    pub fn zeros(segment: &Segment, layout: &Layout) -> Self {
        Self {
            knots: vec![0.0; segment.prisms.coordinates() * segment.grid.knots],
            blocks: vec![BlockVector::zeros(layout.block()); segment.grid.blocks],
        }
    }

    /// Adds a multiple of other gradients.
    pub fn add_multiple(&mut self, other: &Self, multiple: f64) {
        let knots = self.knots.iter_mut().zip(&other.knots);
        knots.for_each(|(sum, value)| *sum += multiple * value);
        let blocks = self.blocks.iter_mut().zip(&other.blocks);
        blocks.for_each(|(sum, value)| sum.axpy(multiple, value, 1.0));
    }

    /// Adds a gradient by the position of a reading's prism, with so many coordinates of a knot.
    pub fn add(
        &mut self,
        residual: &ReadingResidual,
        by_block: &BlockColumns,
        gradient: &Vector3<f64>,
        local: usize,
    ) {
        for (k, factor) in residual.weights.position.iter().enumerate() {
            let knot = &mut self.knots[local * (residual.weights.first + k)..];
            for axis in 0..3 {
                knot[3 * residual.prism + axis] += factor * gradient[axis];
            }
        }
        for (column, jacobian) in by_block.iter().flatten() {
            self.blocks[residual.block][*column] += jacobian.dot(gradient);
        }
    }

    /// Adds the gradient of the rig's distances.
    pub fn add_distances(
        &mut self,
        grid: &KnotGrid,
        point: &LinearisationPoint<'_>,
        levels: &NoiseLevels,
    ) {
        let (layout, prisms) = (point.layout, point.prisms);
        let local = prisms.coordinates();
        let precision = levels.distance_m.powi(-2);
        for time_s in distance_times_s(grid) {
            let weights = grid.weights(time_s);
            let block = &mut self.blocks[grid.block_at(time_s)];
            for (pair, (a, b)) in prisms.pairs.iter().copied() {
                let (along, residual_m) =
                    distance_residual(point, &weights, (a, b), point.distances_m[pair]);
                let gradient = along * (residual_m * precision);
                for (k, factor) in weights.position.iter().enumerate() {
                    let knot = &mut self.knots[local * (weights.first + k)..];
                    for axis in 0..3 {
                        knot[3 * a + axis] += factor * gradient[axis];
                        knot[3 * b + axis] -= factor * gradient[axis];
                    }
                }
                block[layout.block_distances() + pair] -= residual_m * precision;
            }
        }
    }
}
