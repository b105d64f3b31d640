//! Covariance of poses and constants by errors of prisms that repeat with the incidence ([`super::facets`]).
//!
//! Each coefficient of the errors changes the readings of its station. Their gradient `Jᵀ Σ⁻¹ ε_F` is eliminated as that of the residuals is,
//! reading by reading: within a block the incidence changes with the tilts of the vehicle that determine heights. The solution is
//! the change of the estimate (Schmidt 1966).
//!
//! A distance of the rig determines heights by its tilts. The errors change it, and the tilts as well: their product does not average out,
//! and where a vehicle hardly tilts it is larger than the linear change. So the motion follows some draws of all coefficients, and the
//! gradient of the distances to the second order is eliminated in the same way.

use std::collections::VecDeque;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::block_jacobians::BlockJacobian;
use super::chain::ChainVector;
use super::chain_factor::{FactorRow, chain_shape};
use super::drive::Segment;
use super::equations::RandomSigns;
use super::facets::{FACETS_M, ORDERS, incidence_rad};
use super::gauss_newton_step::GaussNewtonStep;
use super::gradients::Gradients;
use super::linearisation::Linearisation;
use super::motion_band::MotionBand;
use super::priors::Priors;
use super::residuals::{LinearisationPoint, NoiseLevels, ReadingResidual, spline_value};
use super::state_vector::{BlockVector, ConstantsMatrix, Layout, StateVector};
use crate::linear_algebra::bordered_rows::{RowShape, forward_substitute};
use crate::network::{Number, Station};
use crate::progress::{Cancelled, Progress};

/// Coefficients of the errors along one axis of the sights of a station.
const TERMS: usize = 2 * ORDERS.len();
/// Coefficients of a station.
const OF_STATION: usize = FACETS_M.len() * TERMS;
/// Segments whose gradients are in memory at once.
const SEGMENTS: usize = 16;
/// Draws of all coefficients for the effects of the second order.
const DRAWS: usize = 8;

/// Covariance by the facets of the prisms.
#[derive(Clone, Debug)]
pub struct FacetCovariance {
    /// Covariance of (x, y, z, yaw) of all stations but the first (m, rad).
    pub poses: DMatrix<f64>,
    pub constants: ConstantsMatrix,
}

impl FacetCovariance {
    fn zeros(layout: &Layout) -> Self {
        let square = |size: usize| DMatrix::zeros(size, size);
        Self { poses: square(layout.poses()), constants: square(layout.constants) }
    }

    /// The covariance at the state of a step with these priors; `sensitivity` is the response of the poses to a gradient.
    pub fn new(
        step: &GaussNewtonStep,
        (state, priors): (&StateVector, &Priors),
        sensitivity: &[ChainVector],
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        let (matrix, layout) = (&step.normal.matrix, &step.normal.drive().layout);
        // One prism has no heading.
        if layout.prisms() < 2 || !priors.has_facets {
            return Ok(Self::zeros(layout));
        }
        let shape = chain_shape(layout);
        let mut effects = vec![FacetEffect::zeros(shape, sensitivity.len()); effects_of(layout)];
        let mut gradients = BlockGradients { step, state, next: 0, of_blocks: VecDeque::new() };
        for chunk in matrix.chunks() {
            let gradients = gradients.take(chunk.len(), progress)?;
            let factor = step.factor.rows(chunk.clone());
            let blocks: Vec<(BlockJacobian, DMatrix<f64>)> = chunk
                .map(|block| {
                    let jacobian = matrix.jacobians.of_block(block);
                    let by_pose = by_pose(&jacobian, sensitivity, block);
                    (jacobian, by_pose)
                })
                .collect();
            effects.par_iter_mut().enumerate().for_each(|(coefficient, effect)| {
                for ((block, of_block), row) in blocks.iter().zip(&gradients).zip(factor.iter()) {
                    effect.eliminate(&of_block[coefficient], block, row, shape);
                }
            });
        }
        let mut covariance = Self::zeros(layout);
        for (index, FacetEffect { constants, poses, .. }) in effects.into_iter().enumerate() {
            let is_draw = index >= OF_STATION * layout.stations();
            let share = if is_draw { 1.0 / DRAWS as f64 } else { 1.0 };
            let constants = step.factor.solve_constants(&constants[..layout.constants]);
            covariance.constants.ger(share, &constants, &constants, 1.0);
            if !sensitivity.is_empty() {
                covariance.poses.ger(share, &poses, &poses, 1.0);
            }
        }
        Ok(covariance)
    }
}

/// Number of coefficients of all stations, and of draws.
fn effects_of(layout: &Layout) -> usize {
    OF_STATION * layout.stations() + DRAWS
}

/// Change of a block's unknowns by that of each pose: a column a pose.
fn by_pose(jacobian: &BlockJacobian, sensitivity: &[ChainVector], block: usize) -> DMatrix<f64> {
    let (by_constants, by_slow) = jacobian;
    let mut all = DMatrix::zeros(by_constants.nrows(), sensitivity.len());
    for (mut column, pose) in all.column_iter_mut().zip(sensitivity) {
        column.gemv(1.0, by_constants, &pose.constants, 0.0);
        column.gemv(1.0, by_slow, &pose.slow[block], 1.0);
    }
    all
}

/// The effect of one coefficient, as far as the chain has been eliminated.
#[derive(Clone)]
struct FacetEffect {
    /// Right-hand side of the next block, and of the constants.
    slow: Vec<f64>,
    constants: Vec<f64>,
    poses: DVector<f64>,
}

impl FacetEffect {
    fn zeros(shape: RowShape, poses: usize) -> Self {
        let (slow, constants) = (vec![0.0; shape.size], vec![0.0; shape.border]);
        Self { slow, constants, poses: DVector::zeros(poses) }
    }

    /// Adds the gradient by the unknowns of a block, and eliminates its slow states.
    fn eliminate(
        &mut self,
        gradient: &BlockVector,
        ((by_constants, by_slow), by_pose): &(BlockJacobian, DMatrix<f64>),
        factor: &FactorRow,
        shape: RowShape,
    ) {
        self.poses.gemv_tr(1.0, by_pose, gradient, 1.0);
        let add = |sums: &mut [f64], jacobian: &DMatrix<f64>| {
            for (sum, column) in sums.iter_mut().zip(jacobian.column_iter()) {
                *sum += column.dot(gradient);
            }
        };
        add(&mut self.slow, by_slow);
        add(&mut self.constants, by_constants);
        let mut next = vec![0.0; shape.size];
        forward_substitute(factor, shape, &mut self.slow, &mut next, &mut self.constants);
        self.slow = next;
    }
}

/// Gradients of the blocks of a drive by coefficient, some segments at a time.
struct BlockGradients<'a> {
    step: &'a GaussNewtonStep,
    state: &'a StateVector,
    /// The next segment.
    next: usize,
    /// A gradient for each coefficient of each block.
    of_blocks: VecDeque<Vec<BlockVector>>,
}

impl BlockGradients<'_> {
    /// Takes the gradients of the next blocks.
    fn take(
        &mut self,
        count: usize,
        progress: &Progress,
    ) -> Result<Vec<Vec<BlockVector>>, Cancelled> {
        let Self { step, state, .. } = self;
        let linearisation = Linearisation::new(state, &step.normal.matrix.jacobians);
        let last = step.segments.len();
        while self.of_blocks.len() < count && self.next < last {
            progress.check()?;
            let some = self.next..last.min(self.next + SEGMENTS);
            let of_segment = |index: usize, band: &MotionBand| {
                let (segment, point) = linearisation.segment(index);
                let weights = &step.segments[index].weights;
                of_segment(segment, &point, &step.levels, weights, band)
            };
            let gradients = step.map_segments(state, some.clone(), of_segment);
            self.next = some.end;
            // Each is there: the same matrix was positive definite before. Without one, its blocks would count as those of no facets.
            for (index, gradients) in some.zip(gradients) {
                let none = || {
                    let layout = &step.normal.drive().layout;
                    let of_block = BlockVector::zeros(layout.block());
                    vec![vec![of_block; effects_of(layout)]; linearisation.blocks(index).len()]
                };
                self.of_blocks.extend(gradients.unwrap_or_else(none));
            }
        }
        Ok(self.of_blocks.drain(..count.min(self.of_blocks.len())).collect())
    }
}

/// Returns the gradients of a segment's blocks by each coefficient and each draw, with the motion eliminated.
fn of_segment(
    segment: &Segment,
    point: &LinearisationPoint<'_>,
    levels: &NoiseLevels,
    weights: &[f64],
    band: &MotionBand,
) -> Vec<Vec<BlockVector>> {
    let layout = point.layout;
    let mut sums = vec![Gradients::zeros(segment, layout); OF_STATION * layout.stations()];
    // A single prism has no heading.
    if point.prisms.count() > 1 {
        let mut weights = weights.iter();
        for (station, readings) in segment.readings.each() {
            let of_station = &mut sums[OF_STATION * station.index()..][..OF_STATION];
            for (reading, weight) in readings.iter().zip(weights.by_ref()) {
                let residual = ReadingResidual::new(&segment.grid, point, levels, station, reading);
                add_reading(of_station, &residual, point, station, *weight);
            }
        }
    }
    let second_order = second_order(segment, point, levels, &sums, band);
    sums.extend(second_order);
    let mut of_blocks = vec![Vec::with_capacity(sums.len()); segment.grid.blocks];
    let mut both: Vec<(&mut [f64], &mut [BlockVector])> =
        sums.iter_mut().map(|sum| (&mut sum.knots[..], &mut sum.blocks[..])).collect();
    band.eliminate_from(&mut both);
    for Gradients { blocks, .. } in sums {
        of_blocks.iter_mut().zip(blocks).for_each(|(all, of_block)| all.push(of_block));
    }
    of_blocks
}

/// Returns the gradient of the distances to the second order, by each draw of the coefficients whose gradients these are.
fn second_order(
    segment: &Segment,
    point: &LinearisationPoint<'_>,
    levels: &NoiseLevels,
    of_coefficients: &[Gradients],
    band: &MotionBand,
) -> Vec<Gradients> {
    let distances = |coefficients_m: &[f64], multiple: f64, sum: &mut Gradients| {
        let mut gradient = Gradients::zeros(segment, point.layout);
        let point = LinearisationPoint { coefficients_m, ..*point };
        gradient.add_distances(&segment.grid, &point, levels);
        sum.add_multiple(&gradient, multiple);
    };
    let order = stations_by_distance(point);
    let drawn = |draw: usize| {
        let mut signs = RandomSigns(draw as u64);
        let mut gradient = vec![0.0; point.coefficients_m.len()];
        for station in &order {
            for of_one in &of_coefficients[OF_STATION * station..][..OF_STATION] {
                let sign = signs.next();
                let values = gradient.iter_mut().zip(&of_one.knots);
                values.for_each(|(sum, value)| *sum += sign * value);
            }
        }
        gradient
    };
    let mut changes_m: Vec<Vec<f64>> = (0..DRAWS).map(drawn).collect();
    band.solve_motion(&mut changes_m);
    let of_draw = |changes_m: &Vec<f64>| {
        let mut sum = Gradients::zeros(segment, point.layout);
        for sign in [1.0, -1.0] {
            let both = point.coefficients_m.iter().zip(changes_m);
            let moved_m: Vec<f64> = both.map(|(value, change)| value + sign * change).collect();
            distances(&moved_m, 0.5, &mut sum);
        }
        distances(point.coefficients_m, -1.0, &mut sum);
        sum
    };
    changes_m.iter().map(of_draw).collect()
}

/// Indices of the stations by their distance from station 1: the draws do not follow the numbers of the others.
fn stations_by_distance(point: &LinearisationPoint<'_>) -> Vec<usize> {
    let distance_m = |station: &usize| point.stations[*station].position_m.norm();
    let mut order: Vec<usize> = (0..point.stations.len()).collect();
    order.sort_by(|a, b| distance_m(a).total_cmp(&distance_m(b)));
    order
}

/// Adds the gradient of a reading by each coefficient of its station.
fn add_reading(
    sums: &mut [Gradients],
    residual: &ReadingResidual,
    point: &LinearisationPoint<'_>,
    station: Station,
    weight: f64,
) {
    let columns = residual.block_jacobian(point.layout, station);
    let local = point.prisms.coordinates();
    let weights = &residual.weights;
    let prism_m = |prism: usize| spline_value(point, weights, &weights.position, prism);
    let to_station_m = point.stations[station.index()].position_m - prism_m(residual.prism);
    let (from, to) = rig_axis(point);
    let incidence_rad = incidence_rad(&to_station_m, &(prism_m(to) - prism_m(from)));
    for (axis, rms_m) in FACETS_M.into_iter().enumerate() {
        let sigma_m = rms_m / (ORDERS.len() as f64).sqrt();
        let pull = residual.axes * residual.information.column(axis) * (weight * sigma_m);
        for (order, sums) in ORDERS.into_iter().zip(sums[TERMS * axis..].chunks_exact_mut(2)) {
            let (sin, cos) = (order * incidence_rad).sin_cos();
            sums[0].add(residual, &columns, &(pull * cos), local);
            sums[1].add(residual, &columns, &(pull * sin), local);
        }
    }
}

/// The prisms between which the axis of the rig is, by their places in the segment: those that are furthest apart. It leads to the one that is
/// further from all others, whatever their numbers are.
fn rig_axis(point: &LinearisationPoint<'_>) -> (usize, usize) {
    let pairs = &point.prisms.pairs;
    let length_m = |(pair, _): &&(usize, (usize, usize))| point.distances_m[*pair];
    let longest = pairs.iter().max_by(|a, b| length_m(a).total_cmp(&length_m(b)));
    let (a, b) = longest.map_or((0, 1), |(_, prisms)| *prisms);
    let from_others_m = |prism: usize| {
        let others = pairs.iter().filter(|(_, (a, b))| prism == *a || prism == *b);
        others.map(|(pair, _)| point.distances_m[*pair]).sum::<f64>()
    };
    if from_others_m(b) < from_others_m(a) { (b, a) } else { (a, b) }
}
