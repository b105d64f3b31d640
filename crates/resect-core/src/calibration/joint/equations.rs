//! Normal equations of one segment at a linearisation point.

use std::sync::Arc;

use nalgebra::Vector3;

use super::drive::Segment;
use super::excess_jerk::JerkVariance;
use super::knot_grid::{KnotGrid, ORDER};
use super::loss::{robust_loss, robust_weight};
use super::motion_band::{BlockUnknown, KnotFactors, MotionBand, PROBES, Rows, band_shape};
use super::readings::Reading;
use super::residuals::{
    LinearisationPoint, NoiseLevels, ReadingResidual, distance_residual, distance_times_s,
    is_vertical, jerk_factors, jerk_precisions, jerk_residuals,
};
use super::state_vector::BlockVector;
use crate::network::{PerStation, Station};

/// Steps of a coefficient that are longer are shortened where the readings hardly determine it (m): a third of a rig, whose distances are
/// linear that far.
const DAMPED_M: f64 = 0.3;

/// Robust weights of a segment's readings and then of its jerks, in their order. Steps with fixed weights share them.
pub type RobustWeights = Arc<[f64]>;

/// Noise levels and robust weights of a segment's equations.
#[derive(Clone, Copy)]
pub struct SegmentWeighting<'a> {
    pub levels: NoiseLevels,
    /// Redundancy number of a reading: the share of its error that remains in the residual.
    pub redundancy: f64,
    /// Fixed robust weights; `None` while they are re-estimated.
    pub fixed: Option<&'a RobustWeights>,
}

/// Sums of squared residuals by kind of noise, and their expectation before anything is fitted.
#[derive(Clone, Debug, Default)]
pub struct ResidualSquares {
    pub observed: [f64; PROBES],
    pub expected: [f64; PROBES],
    /// Squares that the fitted motion absorbs, estimated by random probes (Girard 1989).
    pub absorbed: [f64; PROBES],
    /// Observed and expected squares of ranges, horizontal and vertical angles, by station.
    pub by_station: PerStation<[SquareSum; 3]>,
}

/// Sum of squared residuals, and its expectation before anything is fitted.
#[derive(Clone, Copy, Debug, Default)]
pub struct SquareSum {
    pub observed: f64,
    pub expected: f64,
}

/// Indices of the kinds of noise.
pub const RANGES: usize = 0;
pub const HORIZONTAL_ANGLES: usize = 1;
pub const VERTICAL_ANGLES: usize = 2;
pub const STAMPS: usize = 3;
pub const HORIZONTAL_JERKS: usize = 4;
pub const VERTICAL_JERKS: usize = 5;

impl ResidualSquares {
    pub fn zeros(stations: usize) -> Self {
        Self { by_station: PerStation::repeat(stations, Default::default()), ..Self::default() }
    }

    pub fn add(&mut self, other: &Self) {
        for kind in 0..PROBES {
            self.observed[kind] += other.observed[kind];
            self.expected[kind] += other.expected[kind];
            self.absorbed[kind] += other.absorbed[kind];
        }
        let sums = self.by_station.iter_mut().flatten();
        for (sum, other) in sums.zip(other.by_station.iter().flatten()) {
            sum.observed += other.observed;
            sum.expected += other.expected;
        }
    }

    /// Mean redundancy number of a kind: the share of expected squares that the motion leaves; `None` without residuals.
    pub fn redundancy(&self, kind: usize) -> Option<f64> {
        let expected = self.expected[kind];
        (expected > 0.0).then(|| ((expected - self.absorbed[kind]) / expected).clamp(0.0, 1.0))
    }
}

/// Treatment of the unknowns of the blocks while the motion of a segment is eliminated.
#[derive(Clone, Copy)]
pub enum BlockUnknowns<'a> {
    /// They are constant: for a step of the motion alone.
    Constant,
    /// They are the border of the motion.
    Border,
    /// They take this step, by block, and the motion follows.
    Step(&'a [BlockVector]),
}

/// The equations of a segment, before or after the motion is eliminated. Rows of a long drive are not stored.
pub struct SegmentEquations {
    pub band: MotionBand,
    pub squares: ResidualSquares,
    /// Cost of the equations (σ²), with the robust loss unless the weights are fixed.
    pub cost: f64,
    pub weights: RobustWeights,
}

/// Linearises a segment; reuses the memory of `rows`.
pub fn equations(
    segment: &Segment,
    point: &LinearisationPoint<'_>,
    weighting: &SegmentWeighting<'_>,
    unknowns: BlockUnknowns<'_>,
    rows: Rows,
) -> SegmentEquations {
    let (grid, layout) = (&segment.grid, point.layout);
    let (block, steps): (usize, &[BlockVector]) = match unknowns {
        BlockUnknowns::Constant => (0, &[]),
        BlockUnknowns::Border => (layout.block(), &[]),
        BlockUnknowns::Step(steps) => (0, steps),
    };
    // Steps of the motion alone show what it absorbs.
    let has_probes = matches!(unknowns, BlockUnknowns::Constant) && weighting.fixed.is_none();
    let probes = if has_probes { PROBES } else { 0 };
    let shape = band_shape(point.prisms.coordinates(), block, probes);
    let mut builder = EquationsBuilder {
        band: MotionBand::new(rows, shape, block, grid.knots, grid.first_knots()),
        squares: ResidualSquares::zeros(layout.stations()),
        cost: 0.0,
        weights: Vec::new(),
        weighted: 0,
        point,
        weighting,
        steps,
        has_probes,
        signs: RandomSigns(0x5eed),
    };
    for (station, readings) in segment.readings.each() {
        for reading in readings.iter() {
            builder.add_reading(grid, station, reading);
        }
    }
    if !point.prisms.pairs.is_empty() {
        builder.add_distances(grid);
    }
    builder.add_jerks(grid, &segment.excess_jerks);
    builder.add_damping(grid);
    let EquationsBuilder { band, squares, cost, weights, .. } = builder;
    let weights = weighting.fixed.map_or_else(|| weights.into(), Arc::clone);
    SegmentEquations { band, squares, cost, weights }
}

struct EquationsBuilder<'a> {
    band: MotionBand,
    squares: ResidualSquares,
    cost: f64,
    /// Weights while they are re-estimated.
    weights: Vec<f64>,
    /// Number of equations that have their weight.
    weighted: usize,
    point: &'a LinearisationPoint<'a>,
    weighting: &'a SegmentWeighting<'a>,
    /// Known steps of the blocks' unknowns; empty without any.
    steps: &'a [BlockVector],
    /// True if squared residuals and probes are summed.
    has_probes: bool,
    signs: RandomSigns,
}

impl EquationsBuilder<'_> {
    /// Returns the fixed weight, or the robust weight of a squared residual in σ², which is the mean of `numbers` squares. Adds the
    /// cost.
    fn weight(&mut self, square: f64, numbers: f64) -> f64 {
        let (weight, loss) = match self.weighting.fixed {
            Some(fixed) => {
                let weight = fixed[self.weighted];
                (weight, weight * square)
            }
            None => {
                let weight = robust_weight(square);
                self.weights.push(weight);
                (weight, robust_loss(square))
            }
        };
        self.weighted += 1;
        self.cost += numbers * loss; // (14)
        weight
    }

    /// Adds range and two angles of a reading, with the noise of its stamp.
    fn add_reading(&mut self, grid: &KnotGrid, station: Station, reading: &Reading) {
        let levels = &self.weighting.levels;
        let residual = ReadingResidual::new(grid, self.point, levels, station, reading);
        let ReadingResidual { weights, axes, residual_m, information, block, .. } = &residual;
        let knots = KnotFactors { first: weights.first, factors: &weights.position };
        let first = 3 * residual.prism;
        let weighted_m = information * residual_m;
        let square = residual_m.dot(&weighted_m);
        let numbers = 3.0 * self.weighting.redundancy;
        let weight = self.weight(square / numbers, numbers);
        self.cost += self.weighting.redundancy * residual.log_determinant;

        let [along_m, side_m, up_m] =
            [0, 1, 2].map(|axis| Vector3::ith(axis, residual.sigmas_m[axis]));
        let sources = [
            (RANGES, along_m),
            (HORIZONTAL_ANGLES, side_m),
            (VERTICAL_ANGLES, up_m),
            (STAMPS, residual.jitter_m),
        ];
        for (kind, sigma_m) in sources.into_iter().filter(|_| self.has_probes) {
            let gain = information * sigma_m;
            // (15). The weight is squared: outliers must not raise the noise level.
            let observed = (weight * gain.dot(residual_m)).powi(2);
            let expected = weight * weight * gain.dot(&sigma_m);
            self.squares.observed[kind] += observed;
            self.squares.expected[kind] += expected;
            // The stamp is no reading of its own.
            if let Some(sum) = self.squares.by_station[station].get_mut(kind) {
                sum.observed += observed;
                sum.expected += expected;
            }
            let values = axes * gain * (weight * self.signs.next());
            self.band.add_probe(knots, first, kind, values.as_slice());
        }
        let normal = axes * information * axes.transpose() * weight;
        let gradient = axes * weighted_m * weight;
        let columns = residual.block_jacobian(self.point.layout, station);
        let mut remaining = gradient;
        if let Some(step) = self.steps.get(*block) {
            let moved = columns.iter().flatten().map(|(column, by)| by * step[*column]);
            remaining -= normal * moved.sum::<Vector3<f64>>();
        }
        self.band.add_prism(knots, first, &normal, &remaining);
        if !self.band.has_blocks() {
            return;
        }
        for (i, (column, jacobian)) in columns.iter().flatten().enumerate() {
            let values = normal * jacobian;
            let unknown = BlockUnknown { block: *block, column: *column };
            self.band.add_border(knots, first, unknown, values.as_slice());
            let block = &mut self.band.blocks[*block];
            block.gradient[*column] += jacobian.dot(&gradient);
            for (other, other_jacobian) in columns[..=i].iter().flatten() {
                let value = values.dot(other_jacobian);
                block.information[(*column, *other)] += value;
                if other != column {
                    block.information[(*other, *column)] += value;
                }
            }
        }
    }

    /// Adds the distances of the rig as constraints on the splines, once a knot.
    fn add_distances(&mut self, grid: &KnotGrid) {
        let (layout, prisms) = (self.point.layout, self.point.prisms);
        let local = prisms.coordinates();
        let precision = self.weighting.levels.distance_m.powi(-2);
        let (mut information, mut gradient) = (vec![0.0; local * local], vec![0.0; local]);
        for time_s in distance_times_s(grid) {
            let weights = grid.weights(time_s);
            let knots = KnotFactors { first: weights.first, factors: &weights.position };
            let block = grid.block_at(time_s);
            information.fill(0.0);
            gradient.fill(0.0);
            for (pair, (a, b)) in prisms.pairs.iter().copied() {
                let distance_m = self.point.distances_m[pair];
                let (along, residual_m) =
                    distance_residual(self.point, &weights, (a, b), distance_m);
                self.cost += precision * residual_m * residual_m; // (14)
                let column = layout.block_distances() + pair;
                let step_m = self.steps.get(block).map_or(0.0, |step| step[column]);
                let jacobian = [(3 * a, along), (3 * b, -along)];
                let weighted = jacobian.map(|(first, along)| (first, along * precision));
                for (row, by_row) in &weighted {
                    for i in 0..3 {
                        for (column, by_column) in &jacobian {
                            let row = &mut information[local * (row + i) + column..][..3];
                            (0..3).for_each(|j| row[j] += by_row[i] * by_column[j]);
                        }
                        gradient[row + i] += by_row[i] * (residual_m + step_m);
                    }
                }
                if !self.band.has_blocks() {
                    continue;
                }
                for (first, by_distance) in weighted {
                    let unknown = BlockUnknown { block, column };
                    self.band.add_border(knots, first, unknown, (-by_distance).as_slice());
                }
                let block = &mut self.band.blocks[block];
                block.information[(column, column)] += precision;
                block.gradient[column] -= precision * residual_m;
            }
            self.band.add_knot(knots, &information, &gradient);
        }
    }

    /// Adds the smoothness prior of the motion: one equation a coordinate and knot.
    fn add_jerks(&mut self, grid: &KnotGrid, excess_jerks: &[JerkVariance]) {
        let levels = self.weighting.levels;
        let local = self.point.prisms.coordinates();
        let [mut residuals, mut precisions, mut values] = [(); 3].map(|()| vec![0.0; local]);
        let factors = jerk_factors(grid);
        for (first, excess) in excess_jerks.iter().enumerate() {
            jerk_precisions(&levels, excess, &mut precisions);
            jerk_residuals(self.point, first, &factors, &mut residuals);
            let knots = KnotFactors { first, factors: &factors };
            let squares = squares_by_axis(&residuals, &precisions);
            // Vehicles start and stop: their jerks are weighted robustly.
            let weight = self.weight((squares[0] + squares[1]) / local as f64, local as f64);
            // (17). The process noise counts starts and stops fully. Otherwise the motion is so stiff that the vehicle's movements look
            // like noise of stamps.
            let usual = [
                excess.horizontal < levels.horizontal_jerk_m_per_s3.powi(2),
                excess.vertical < levels.vertical_jerk_m_per_s3.powi(2),
            ];
            for (axis, kind) in [HORIZONTAL_JERKS, VERTICAL_JERKS].into_iter().enumerate() {
                if !usual[axis] || !self.has_probes {
                    continue;
                }
                self.squares.observed[kind] += squares[axis];
                self.squares.expected[kind] += [2.0, 1.0][axis] * local as f64 / 3.0;
                for (coordinate, value) in values.iter_mut().enumerate() {
                    let is_own = usize::from(is_vertical(coordinate)) == axis;
                    let sigmas = if is_own { self.signs.next() } else { 0.0 };
                    *value = sigmas * precisions[coordinate].sqrt();
                }
                self.band.add_probe(knots, 0, kind, &values);
            }
            for (residual, precision) in residuals.iter_mut().zip(&mut precisions) {
                *precision *= weight;
                *residual *= *precision;
            }
            self.band.add_each(knots, &precisions, &residuals);
        }
    }

    /// Shortens steps of coefficients that the readings hardly determine (Levenberg 1944). The solution is that without it.
    fn add_damping(&mut self, grid: &KnotGrid) {
        let coordinates = self.point.prisms.coordinates();
        let (precisions, none) = (vec![DAMPED_M.powi(-2); coordinates], vec![0.0; coordinates]);
        for knot in 0..grid.knots {
            let first = knot.min(grid.knots - ORDER);
            let mut factors = [0.0; ORDER];
            factors[knot - first] = 1.0;
            self.band.add_each(KnotFactors { first, factors: &factors }, &precisions, &none);
        }
    }
}

/// Sums of squared residuals (σ²) along horizontal axes and along the vertical one.
fn squares_by_axis(residuals: &[f64], precisions: &[f64]) -> [f64; 2] {
    let mut squares = [0.0; 2];
    for (coordinate, (residual, precision)) in residuals.iter().zip(precisions).enumerate() {
        squares[usize::from(is_vertical(coordinate))] += precision * residual * residual;
    }
    squares
}

/// A reproducible random sequence of +1 and −1 (Steele, Lea & Flood 2014, "splitmix64").
pub struct RandomSigns(pub u64);

impl RandomSigns {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        if (z ^ (z >> 31)) & 1 == 0 { 1.0 } else { -1.0 }
    }
}
