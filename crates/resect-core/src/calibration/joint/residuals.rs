//! The residuals at a linearisation point: of readings, of the rig's distances, and of the motion's smoothness.

use nalgebra::{Matrix3, Vector3};

use super::excess_jerk::JerkVariance;
use super::knot_grid::{KnotGrid, ORDER, SplineWeights};
use super::readings::Reading;
use super::segment_prisms::SegmentPrisms;
use super::state_vector::{BlockVector, Layout};
use super::station_model::StationModel;
use crate::geometry::ARCSECOND_RAD;
use crate::network::{Number, Station};

/// Standard deviation of the rig's distances by the flexibility of its masts (m).
pub const RIG_FLEX_SIGMA_M: f64 = 0.00035;
/// Standard deviation of an observed distance of the rig by the facets of the prisms (m). Errors of a millimetre are the same for as long as a vehicle
/// keeps its incidence.
pub const OBSERVED_DISTANCE_SIGMA_M: f64 = 0.0015;
/// Stated noise of a range of length zero. Source: Trimble S7, 2 mm + 2 ppm (Vaidis et al. 2022, "Experiments").
const RANGE_M: f64 = 0.002;
/// Stated noise of a range by its length. Source: Trimble S7, 2 mm + 2 ppm (Vaidis et al. 2022, "Experiments").
const RANGE_SHARE: f64 = 2e-6;
/// Stated noise of an angle. Source: Trimble S7, one arcsecond (Vaidis et al. 2022, "Experiments").
pub const ANGLE_RAD: f64 = ARCSECOND_RAD;

/// Noise of the readings and process noise of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseLevels {
    /// Factor of a range's stated standard deviation ([`stated_range_m`]).
    pub range: f64,
    /// Standard deviations of a horizontal and a vertical angle (rad).
    pub horizontal_rad: f64,
    pub vertical_rad: f64,
    /// Standard deviation of a stamp (s).
    pub jitter_s: f64,
    /// Standard deviation of an observed distance of the rig, once a knot (m).
    pub distance_m: f64,
    /// Standard deviations of the third derivative of the prisms' positions along horizontal axes and the vertical one (m/s³).
    pub horizontal_jerk_m_per_s3: f64,
    pub vertical_jerk_m_per_s3: f64,
}

impl NoiseLevels {
    /// Standard deviation of a range of length zero (m).
    pub fn range_m(&self) -> f64 {
        self.range * RANGE_M
    }
}

/// Standard deviation that the instrument states for a range of this length (m).
pub fn stated_range_m(range_m: f64) -> f64 {
    RANGE_M + RANGE_SHARE * range_m
}

/// The state that a segment's residuals depend on.
#[derive(Clone, Copy)]
pub struct LinearisationPoint<'a> {
    pub layout: &'a Layout,
    /// The prisms of the segment.
    pub prisms: &'a SegmentPrisms,
    pub stations: &'a [StationModel],
    /// Distances of the prisms by pair (m).
    pub distances_m: &'a [f64],
    /// Middle of the drive (s), from which clock drifts count.
    pub middle_s: f64,
    /// `J_s s` of each block of the segment.
    pub slow: &'a [BlockVector],
    /// Spline coefficients: x, y, z of each prism of the segment, knot by knot (m).
    pub coefficients_m: &'a [f64],
}

/// Columns of a Jacobian by the unknowns of a block: the index of each, and the column (station 1's axes).
pub type BlockColumns = [Option<(usize, Vector3<f64>)>; 5];

/// Residual of a reading: the spline less the corrected reading, in the axes of its sight.
pub struct ReadingResidual {
    pub weights: SplineWeights,
    pub block: usize,
    /// The place of its prism among those of the segment.
    pub prism: usize,
    /// Velocity of the prism, and its part across the sight (m/s).
    pub velocity: Vector3<f64>,
    pub velocity_across: Vector3<f64>,
    /// Unit vectors along the sight, to its right and up, as columns (station 1's axes).
    pub axes: Matrix3<f64>,
    /// Residual along these axes (m).
    pub residual_m: Vector3<f64>,
    /// Inverse covariance of the residual (1/m²).
    pub information: Matrix3<f64>,
    /// Standard deviations along the sight, to its right and up (m), and displacement by one standard deviation of the stamp (m).
    pub sigmas_m: Vector3<f64>,
    pub jitter_m: Vector3<f64>,
    /// Logarithm of the determinant of the covariance, less that without the noise of the stamp.
    pub log_determinant: f64,
}

impl ReadingResidual {
    pub fn new(
        grid: &KnotGrid,
        point: &LinearisationPoint<'_>,
        levels: &NoiseLevels,
        station: Station,
        reading: &Reading,
    ) -> Self {
        let model = &point.stations[station.index()];
        let sight = &reading.sight();
        // (3)
        let mut offset_s =
            model.clock_offset_s + model.clock_drift * (reading.time_s - point.middle_s);
        let block = grid.block_at(reading.time_s - offset_s);
        let slow = &point.slow[block];
        let mut prism_m = model.rotation * model.corrected(sight) + model.position_m;
        if let Some(slot) = station.slot() {
            offset_s += slow[point.layout.block_clocks() + slot];
            prism_m += slow.fixed_rows::<3>(3 * slot);
        }
        let prism =
            point.prisms.of_station[station].expect("a station with readings follows a prism");
        let weights = grid.weights(reading.time_s - offset_s);
        let velocity = spline_value(point, &weights, &weights.velocity, prism);
        let axes = model.rotation * Matrix3::from_columns(&[sight.along, sight.side, sight.up]);
        let along = axes.column(0).into_owned();
        let velocity_across = velocity - along * along.dot(&velocity);
        // (5)
        let difference_m = spline_value(point, &weights, &weights.position, prism)
            - velocity_across * model.latency_s
            - prism_m;

        let sigmas_m = Vector3::new(
            levels.range * stated_range_m(sight.range_m), // (7)
            levels.horizontal_rad * sight.range_m,
            levels.vertical_rad * sight.range_m,
        );
        let precision = sigmas_m.map(|sigma_m| sigma_m.powi(-2));
        // (6). A stamp error displaces the reading along its velocity: inverse of diagonal + rank one (Sherman & Morrison 1950).
        let jitter_m = axes.tr_mul(&velocity) * levels.jitter_s;
        let weighted = precision.component_mul(&jitter_m);
        let information = Matrix3::from_diagonal(&precision)
            - weighted * weighted.transpose() / (1.0 + weighted.dot(&jitter_m));
        let log_determinant = weighted.dot(&jitter_m).ln_1p();
        Self {
            residual_m: axes.tr_mul(&difference_m),
            weights,
            block,
            prism,
            velocity,
            velocity_across,
            axes,
            information,
            sigmas_m,
            jitter_m,
            log_determinant,
        }
    }

    /// Jacobian of the residual by the block's unknowns.
    pub fn block_jacobian(&self, layout: &Layout, station: Station) -> BlockColumns {
        let latency = Some((layout.block_latencies() + station.index(), -self.velocity_across));
        let Some(slot) = station.slot() else { return [latency, None, None, None, None] };
        [
            latency,
            Some((3 * slot, -Vector3::x())),
            Some((3 * slot + 1, -Vector3::y())),
            Some((3 * slot + 2, -Vector3::z())),
            Some((layout.block_clocks() + slot, -self.velocity)),
        ]
    }
}

/// Position (m) or velocity (m/s) of a prism, by the factors of four knots.
pub fn spline_value(
    point: &LinearisationPoint<'_>,
    weights: &SplineWeights,
    factors: &[f64; ORDER],
    prism: usize,
) -> Vector3<f64> {
    let mut sum = Vector3::zeros();
    for (k, factor) in factors.iter().enumerate() {
        let first = 3 * (point.prisms.count() * (weights.first + k) + prism);
        // (4)
        sum += *factor * Vector3::from_column_slice(&point.coefficients_m[first..first + 3]);
    }
    sum
}

/// Times at which the rig's distances are observed: once a knot (s).
pub fn distance_times_s(grid: &KnotGrid) -> impl Iterator<Item = f64> + use<> {
    let (start_s, end_s, knot_s) = (grid.start_s, grid.end_s, grid.knot_s);
    let steps = ((end_s - start_s) / knot_s).ceil() as usize;
    (0..=steps).map(move |step| (start_s + knot_s * step as f64).min(end_s))
}

/// The unit vector from prism b to prism a, which is the Jacobian of their distance by a, and the residual of the distance (m).
pub fn distance_residual(
    point: &LinearisationPoint<'_>,
    weights: &SplineWeights,
    (a, b): (usize, usize),
    distance_m: f64,
) -> (Vector3<f64>, f64) {
    let prism_m = |prism: usize| spline_value(point, weights, &weights.position, prism);
    let between = prism_m(a) - prism_m(b);
    let length_m = between.norm().max(1e-9);
    (between / length_m, length_m - distance_m) // (8)
}

/// Jacobian of a jerk by four knots (1/s³).
pub fn jerk_factors(grid: &KnotGrid) -> [f64; ORDER] {
    let scale = grid.knot_s.powi(-3);
    [-scale, 3.0 * scale, -3.0 * scale, scale] // (9)
}

/// Precisions of a jerk by coordinate (s⁶/m²); `excess` is its variance beyond that of the whole drive.
pub fn jerk_precisions(levels: &NoiseLevels, excess: &JerkVariance, precisions: &mut [f64]) {
    let horizontal = levels.horizontal_jerk_m_per_s3.powi(2) + excess.horizontal;
    let vertical = levels.vertical_jerk_m_per_s3.powi(2) + excess.vertical;
    for (coordinate, precision) in precisions.iter_mut().enumerate() {
        *precision = if is_vertical(coordinate) { vertical } else { horizontal }.recip();
    }
}

/// Returns true for the coordinates of a knot that are heights.
pub fn is_vertical(coordinate: usize) -> bool {
    coordinate % 3 == 2
}

/// Writes the jerk of four knots from `first` on to `residuals`, by coordinate (m/s³).
pub fn jerk_residuals(
    point: &LinearisationPoint<'_>,
    first: usize,
    factors: &[f64; ORDER],
    residuals: &mut [f64],
) {
    let local = residuals.len();
    residuals.fill(0.0);
    for (knot, factor) in point.coefficients_m[local * first..].chunks_exact(local).zip(factors) {
        residuals.iter_mut().zip(knot).for_each(|(residual, value)| *residual += factor * value);
    }
}
