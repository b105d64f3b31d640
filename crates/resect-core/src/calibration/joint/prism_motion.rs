//! Positions and velocities of the prisms at any instant of a solution, with their covariance.
//!
//! The motion is that of the splines. Its covariance combines that of four knots given the unknowns of their block
//! ([`super::knot_covariance`]) with that of the block's unknowns ([`super::chain_factor`]): transforms, clocks, instruments, and
//! stations that settle. An instant between two segments has no motion, nor has a prism that is not followed there.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Matrix3, SMatrix, Vector3, Vector4};
use rayon::prelude::*;

use super::block_jacobians::reference_shift_m;
use super::cut_motion::{CutMotion, cut_span_s, estimate_cut_motion};
use super::drive::{Drive, Segment};
use super::gauss_newton_step::{GaussNewtonStep, RowBuffers};
use super::knot_covariance::{KnotCovariance, each_knot_covariance};
use super::knot_grid::{ORDER, SplineWeights};
use super::linearisation::{Linearisation, Weighting};
use super::motion_band::MotionBand;
use super::priors::Priors;
use super::prisms_of_instant::PrismsOfInstant;
use super::settling::station_1_by_relative;
use super::state_vector::{ConstantsMatrix, Layout, Slow, StateVector};
use crate::calibration::ErrorSizes;
use crate::network::{PerStation, Station};
use crate::progress::{Cancelled, Progress};

/// The solution of an estimate, from which its motion is evaluated.
#[derive(Clone, Debug)]
pub struct Solution {
    pub(super) drive: Arc<Drive>,
    pub(super) state: StateVector,
    pub(super) weighting: Weighting,
    pub(super) priors: Priors,
    pub(super) sizes: ErrorSizes,
    /// Covariance of the constants beyond that of the normal equations: by the facets of the prisms and the curvature of the heights.
    pub(super) added_covariance: Arc<ConstantsMatrix>,
}

/// The prisms that are followed at one instant: x, y, z of each, in the frame of station 1 as it was set up.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionInstant {
    pub time_s: f64,
    /// Their places among the prisms of the drive, in order.
    pub prisms: Arc<[usize]>,
    pub position_m: DVector<f64>,
    pub velocity_m_per_s: DVector<f64>,
    /// Covariances of the positions (m²), and of the velocities (m²/s²).
    pub position_covariance: DMatrix<f64>,
    pub velocity_covariance: DMatrix<f64>,
}

/// One prism at one instant, in the frame of station 1 as it was set up.
#[derive(Clone, Debug, PartialEq)]
pub struct PrismInstant {
    pub time_s: f64,
    pub position_m: Vector3<f64>,
    pub velocity_m_per_s: Vector3<f64>,
    /// Covariances of the position (m²), and of the velocity (m²/s²).
    pub position_covariance: Matrix3<f64>,
    pub velocity_covariance: Matrix3<f64>,
}

/// The prisms that are followed at one instant, without their covariance.
#[derive(Clone, Debug, PartialEq)]
pub struct PrismsAtInstant {
    /// Their places among the prisms of the drive, in order.
    pub places: Arc<[usize]>,
    /// Positions in the frame of station 1 as it was set up (m).
    pub position_m: Vec<Vector3<f64>>,
    /// Time to the nearest reading of each (s).
    pub to_reading_s: Vec<f64>,
}

impl MotionInstant {
    /// Position of a prism (m), by its place among those that are followed.
    pub fn prism_m(&self, place: usize) -> Vector3<f64> {
        self.position_m.fixed_rows::<3>(3 * place).into()
    }

    /// A prism, by its place among those that are followed.
    pub fn prism(&self, place: usize) -> PrismInstant {
        let at = 3 * place;
        PrismInstant {
            time_s: self.time_s,
            position_m: self.prism_m(place),
            velocity_m_per_s: self.velocity_m_per_s.fixed_rows::<3>(at).into(),
            position_covariance: self.position_covariance.fixed_view::<3, 3>(at, at).into(),
            velocity_covariance: self.velocity_covariance.fixed_view::<3, 3>(at, at).into(),
        }
    }
}

/// Jacobian of positions by the constants of a drive, and the covariance of the constants.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConstantsJacobian {
    /// By time (s): a row for each coordinate of the prisms (m), a column for each constant.
    pub instants: Vec<(f64, DMatrix<f64>)>,
    pub covariance: DMatrix<f64>,
}

impl Solution {
    /// The network of the solution.
    pub fn layout(&self) -> &Layout {
        &self.drive.layout
    }

    /// The motion at increasing times within segments (s, stamps of station 1).
    pub fn instants(
        &self,
        time_s: &[f64],
        progress: &Progress,
    ) -> Result<Vec<MotionInstant>, Cancelled> {
        let Some(step) = self.linearise(progress)? else { return Ok(Vec::new()) };
        let frames = self.frames(&step);
        self.map_instants(&step, time_s, progress, |instant| {
            motion_instant(&instant, &frames[instant.block])
        })
    }

    /// Jacobian of the positions at increasing times by the constants: the errors that all instants have in common.
    pub fn constants_jacobian(
        &self,
        time_s: &[f64],
        progress: &Progress,
    ) -> Result<ConstantsJacobian, Cancelled> {
        let Some(step) = self.linearise(progress)? else {
            return Ok(ConstantsJacobian::default());
        };
        let jacobians = &step.normal.matrix.jacobians;
        let instants = self.map_instants(&step, time_s, progress, |at| {
            let own = jacobians.of_block(at.block).0;
            let frame_by_constants = with_motion(&own, &jacobians.of_motion(at.block).0);
            let by_knots = jacobian_by_knots(at.local(), &at.weights.position);
            let knots_m = DVector::from_column_slice(&at.knots_m[..by_knots.ncols()]);
            let position_m = &by_knots * knots_m;
            let by_frame = jacobian_by_frame(&(by_knots * &at.covariance.by_block), &position_m);
            (at.time_s, at.prisms.rows(by_frame * frame_by_constants))
        })?;
        Ok(ConstantsJacobian { instants, covariance: self.constants_covariance(&step) })
    }

    /// Covariance of the constants, with that beyond the normal equations.
    pub(super) fn constants_covariance(&self, step: &GaussNewtonStep) -> ConstantsMatrix {
        step.factor.constants_covariance() + &*self.added_covariance
    }

    fn linearise(&self, progress: &Progress) -> Result<Option<GaussNewtonStep>, Cancelled> {
        let Self { drive, state, weighting, priors, .. } = self;
        GaussNewtonStep::new(drive, state, weighting, priors, &mut RowBuffers::default(), progress)
    }

    /// Maps each of some increasing times that lies within a segment.
    fn map_instants<T: Send>(
        &self,
        step: &GaussNewtonStep,
        time_s: &[f64],
        progress: &Progress,
        map: impl Fn(InstantInput<'_>) -> T + Sync,
    ) -> Result<Vec<T>, Cancelled> {
        let drive = &self.drive;
        let linearisation = Linearisation::new(&self.state, &step.normal.matrix.jacobians);
        let across_cut = |index: usize| {
            progress.check()?;
            let Some(span_s) = cut_span_s(drive, index) else { return Ok(None) };
            let times_s = between(time_s, |t| t < span_s[0], |t| t > span_s[1]);
            if times_s.is_empty() {
                return Ok(None);
            }
            // Without a motion across the cut, each side uses its own.
            let motion = estimate_cut_motion(&linearisation, &self.weighting, index);
            Ok(motion.map(|CutMotion { segment, coefficients_m, band }| {
                let last_block = linearisation.first_blocks[index + 1] - 1;
                (span_s, map_times(&segment, &coefficients_m, &band, (times_s, last_block), &map))
            }))
        };
        let cuts = (0..drive.segments.len()).into_par_iter().map(across_cut);
        let cuts: Vec<_> = cuts.collect::<Result<_, Cancelled>>()?;
        let (cut_spans_s, of_cuts): (Vec<_>, Vec<_>) = cuts.into_iter().map(Option::unzip).unzip();
        let of_segment = |index: usize, band: &MotionBand| {
            let segment = &drive.segments[index];
            let grid = &segment.grid;
            let before = index.checked_sub(1).and_then(|k| cut_spans_s[k]);
            let after = cut_spans_s[index];
            let times_s = between(
                time_s,
                |t| t < grid.start_s || before.is_some_and(|span_s| t <= span_s[1]),
                |t| t > grid.end_s || after.is_some_and(|span_s| t >= span_s[0]),
            );
            let coefficients_m = &self.state.coefficients_m[index];
            let first_block = linearisation.first_blocks[index];
            map_times(segment, coefficients_m, band, (times_s, first_block), &map)
        };
        let of_segments = step.map_segments(&self.state, 0..drive.segments.len(), of_segment);
        progress.check()?;
        let mapped = of_segments.into_iter().zip(of_cuts).flat_map(|(own, cut)| [own, cut]);
        Ok(mapped.flatten().flatten().collect())
    }

    /// The prisms that are followed at an instant (s, stamps of station 1).
    ///
    /// Returns `None` outside of all segments. This evaluates the splines without covariance, fast enough for each frame of a window.
    /// Unlike [`Self::instants`] it ignores the motion across cuts ([`super::cut_motion`]).
    pub fn prisms_at(&self, time_s: f64) -> Option<PrismsAtInstant> {
        let (layout, segments) = (self.layout(), &self.drive.segments);
        let index = segments.partition_point(|segment| segment.grid.end_s < time_s);
        let segment = segments.get(index)?;
        let grid = &segment.grid;
        if !grid.contains(time_s) {
            return None;
        }
        let first_block: usize = segments[..index].iter().map(|segment| segment.grid.blocks).sum();
        let slow = &self.state.slow[first_block + grid.block_at(time_s)];
        let settled = settled(&self.station_1_by_relative().0, slow);
        let mean_sights = &self.drive.mean_sights[first_block + grid.block_at(time_s)];
        let shift_m = reference_shift_m(layout, &self.state.constants, mean_sights, slow);
        let weights = grid.weights(time_s);
        let local = segment.prisms.coordinates();
        let knots_m = &self.state.coefficients_m[index][local * weights.first..];
        let position_m = |prism: usize| {
            let knot_m =
                |k: usize| Vector3::from_column_slice(&knots_m[local * k + 3 * prism..][..3]);
            (0..ORDER).map(|k| weights.position[k] * knot_m(k)).sum::<Vector3<f64>>()
        };
        let position_m = |prism| as_set_up(&(position_m(prism) + shift_m), &settled);
        let prisms = 0..segment.prisms.count();
        Some(PrismsAtInstant {
            places: Arc::clone(&segment.prisms.in_drive),
            position_m: prisms.clone().map(position_m).collect(),
            to_reading_s: prisms.map(|prism| segment.to_reading_s(prism, time_s)).collect(),
        })
    }

    /// Start and end of each segment that has all prisms of the drive (s).
    pub fn spans_of_all_prisms_s(&self) -> Vec<[f64; 2]> {
        let complete = self.drive.segments.iter().filter(|segment| segment.prisms.is_complete());
        complete.map(|segment| [segment.grid.start_s, segment.grid.end_s]).collect()
    }

    /// Regression of station 1's own settling on the relative one, and the variance that remains.
    fn station_1_by_relative(&self) -> (DMatrix<f64>, SMatrix<f64, 4, 4>) {
        station_1_by_relative(&self.sizes, &self.priors.mean, self.layout().moved())
    }

    /// Number of readings that the estimate takes, by station.
    pub fn readings(&self) -> PerStation<usize> {
        let of_station = |station: Station| {
            self.drive.segments.iter().map(|segment| segment.readings[station].len()).sum()
        };
        PerStation::from_fn(self.layout().stations(), of_station)
    }

    /// Start and end of each segment (s).
    pub fn spans_s(&self) -> impl Iterator<Item = [f64; 2]> {
        self.drive.segments.iter().map(|segment| [segment.grid.start_s, segment.grid.end_s])
    }

    /// Rate of the slowest station's readings (Hz), which is that of the knots.
    pub fn readings_hz(&self) -> f64 {
        self.drive.segments.first().map_or(1.0, |segment| 1.0 / segment.grid.knot_s)
    }

    /// Pose of station 1 and covariance of each block's frame.
    fn frames(&self, step: &GaussNewtonStep) -> Vec<BlockFrame> {
        let (station_1_by_slow, remaining) = self.station_1_by_relative();
        // Settling displaces along x, y, z and rotates about z.
        let by_settling = SMatrix::<f64, 6, 4>::from_fn(|row, component| {
            f64::from(row == if component < 3 { component } else { 5 })
        });
        let constants_covariance = self.constants_covariance(step);
        let mut frames = vec![BlockFrame::default(); self.drive.block_times_s.len()];
        let shares = step.slow_precisions.variance_shares();
        let jacobians = &step.normal.matrix.jacobians;
        step.factor.each_covariance(|block, slow| {
            let (block_by_constants, block_by_slow) = jacobians.of_block(block);
            let (motion_by_constants, motion_by_slow) = jacobians.of_motion(block);
            let by_constants = with_motion(&block_by_constants, &motion_by_constants);
            let mut by_slow = with_motion(&block_by_slow, &motion_by_slow);
            let first = block_by_slow.nrows();
            let mut settling = by_slow.view_mut((first, 0), (6, station_1_by_slow.ncols()));
            settling += by_settling * &station_1_by_slow;
            let across = &by_constants * slow.with_constants.transpose() * by_slow.transpose();
            let mut covariance = &by_constants * &constants_covariance * by_constants.transpose()
                + &by_slow * &slow.own * by_slow.transpose()
                + &across
                + across.transpose();
            let mut station_1 = covariance.view_mut((first, first), (6, 6));
            station_1 += by_settling * remaining * by_settling.transpose() * shares[block];
            let settled = settled(&station_1_by_slow, &self.state.slow[block]);
            let shift_m = reference_shift_m(
                self.layout(),
                &self.state.constants,
                &self.drive.mean_sights[block],
                &self.state.slow[block],
            );
            frames[block] = BlockFrame { shift_m, settled, covariance };
        });
        frames
    }
}

/// Rows of a block's unknowns, followed by the six of its motion.
fn with_motion(block: &DMatrix<f64>, motion: &DMatrix<f64>) -> DMatrix<f64> {
    let mut rows = block.clone().resize_vertically(block.nrows() + motion.nrows(), 0.0);
    rows.rows_mut(block.nrows(), motion.nrows()).copy_from(motion);
    rows
}

/// Settling of station 1 (x, y, z, yaw; m, rad) by the slow states.
fn settled(station_1_by_slow: &DMatrix<f64>, slow: &Slow) -> Vector4<f64> {
    let settled = station_1_by_slow * slow.rows(0, station_1_by_slow.ncols());
    settled.fixed_rows::<4>(0).into()
}

/// Input of the evaluation at one instant.
struct InstantInput<'a> {
    time_s: f64,
    prisms: PrismsOfInstant,
    weights: SplineWeights,
    /// Coefficients from the first of the four knots on (m).
    knots_m: &'a [f64],
    covariance: &'a KnotCovariance,
    /// Index of the block in the drive.
    block: usize,
}

/// Maps some increasing times of a segment at which a prism is followed; the segment's first block has an index in the drive.
fn map_times<T>(
    segment: &Segment,
    coefficients_m: &[f64],
    band: &MotionBand,
    (times_s, first_block): (&[f64], usize),
    map: &impl Fn(InstantInput<'_>) -> T,
) -> Vec<T> {
    let grid = &segment.grid;
    let mut remaining: Vec<(SplineWeights, f64)> =
        times_s.iter().map(|t| (grid.weights(*t), *t)).collect();
    let read_spans_s: Vec<Option<[f64; 2]>> =
        (0..segment.prisms.count()).map(|prism| segment.read_span_s(prism)).collect();
    let mut mapped = Vec::with_capacity(remaining.len());
    each_knot_covariance(band, |covariance| {
        let is_next = |(weights, _): &mut (SplineWeights, f64)| weights.first == covariance.first;
        while let Some((weights, time_s)) = remaining.pop_if(is_next) {
            let knots_m = &coefficients_m[band.shape().size * weights.first..];
            let block = first_block + grid.block_at(time_s);
            let prisms = PrismsOfInstant::at(time_s, &read_spans_s, &segment.prisms);
            if !prisms.in_drive.is_empty() {
                let instant = InstantInput { time_s, prisms, weights, knots_m, covariance, block };
                mapped.push(map(instant));
            }
        }
    });
    mapped.reverse();
    mapped
}

/// Returns those of some increasing times that are neither early nor late.
fn between(
    time_s: &[f64],
    is_early: impl Fn(f64) -> bool,
    is_late: impl Fn(f64) -> bool,
) -> &[f64] {
    let from = time_s.partition_point(|t| is_early(*t));
    &time_s[from..time_s.partition_point(|t| !is_late(*t)).max(from)]
}

/// Settling of station 1 until a block, and the covariance of the frame's unknowns: those of the block, then displacement (m) and
/// rotation (rad) of station 1 with its readings.
#[derive(Clone, Default)]
struct BlockFrame {
    /// Correction of station 1's slow errors in the positions (m).
    shift_m: Vector3<f64>,
    /// x, y, z (m) and yaw (rad) of station 1 since its set-up.
    settled: Vector4<f64>,
    covariance: DMatrix<f64>,
}

impl InstantInput<'_> {
    /// Coefficients of a knot.
    fn local(&self) -> usize {
        self.covariance.covariance.nrows() / ORDER
    }
}

/// Jacobian of a spline's value by the coefficients of four knots, with the factor of each.
fn jacobian_by_knots(local: usize, factors: &[f64; ORDER]) -> DMatrix<f64> {
    let element = |i: usize, j: usize| if j % local == i { factors[j / local] } else { 0.0 };
    DMatrix::from_fn(local, ORDER * local, element)
}

/// Jacobian of prisms at a position (m) by the frame's unknowns, from that by the block's unknowns.
fn jacobian_by_frame(by_block: &DMatrix<f64>, position_m: &DVector<f64>) -> DMatrix<f64> {
    let block = by_block.ncols();
    let mut jacobian = by_block.clone().resize_horizontally(block + 6, 0.0);
    for x in (0..position_m.len()).step_by(3) {
        let prism_m = position_m.fixed_rows::<3>(x).into_owned();
        jacobian.fixed_view_mut::<3, 3>(x, block).fill_with_identity();
        jacobian.fixed_view_mut::<3, 3>(x, block + 3).copy_from(&jacobian_by_rotation(&prism_m));
    }
    jacobian
}

/// Transforms a position (m) from the frame of station 1 as it stands to its frame as it was set up.
fn as_set_up(position_m: &Vector3<f64>, settled: &Vector4<f64>) -> Vector3<f64> {
    position_m + settled.fixed_rows::<3>(0) + settled[3] * Vector3::z().cross(position_m)
}

/// Jacobian of a vector by rotations about x, y, z (per rad).
fn jacobian_by_rotation(vector: &Vector3<f64>) -> Matrix3<f64> {
    -vector.cross_matrix()
}

fn motion_instant(input: &InstantInput<'_>, frame: &BlockFrame) -> MotionInstant {
    let InstantInput { time_s, prisms, weights, knots_m, covariance: knots, .. } = input;
    let local = input.local();
    let value = |factors: &[f64; ORDER]| {
        DVector::from_fn(local, |i, _| {
            factors.iter().enumerate().map(|(k, factor)| factor * knots_m[local * k + i]).sum()
        })
    };
    let (spline_m, spline_m_per_s) = (value(&weights.position), value(&weights.velocity));
    let position_by_knots = jacobian_by_knots(local, &weights.position);
    let velocity_by_knots = jacobian_by_knots(local, &weights.velocity);
    let position_by_frame = jacobian_by_frame(&(&position_by_knots * &knots.by_block), &spline_m);
    let velocity_by_block = &velocity_by_knots * &knots.by_block;
    let block = velocity_by_block.ncols();
    let mut velocity_by_frame = velocity_by_block.resize_horizontally(block + 6, 0.0);
    let (mut position_m, mut velocity_m_per_s) = (spline_m.clone(), spline_m_per_s.clone());
    for x in (0..local).step_by(3) {
        let seen_m: Vector3<f64> = spline_m.fixed_rows::<3>(x).into_owned();
        let prism_m = as_set_up(&(seen_m + frame.shift_m), &frame.settled);
        position_m.fixed_rows_mut::<3>(x).copy_from(&prism_m);
        let prism_m_per_s: Vector3<f64> = spline_m_per_s.fixed_rows::<3>(x).into_owned();
        let rotated = jacobian_by_rotation(&prism_m_per_s);
        velocity_by_frame.fixed_view_mut::<3, 3>(x, block + 3).copy_from(&rotated);
        let by_yaw = Vector3::z().cross(&prism_m_per_s);
        for axis in 0..3 {
            velocity_m_per_s[x + axis] += frame.settled[3] * by_yaw[axis];
        }
    }
    let covariance = |by_knots: &DMatrix<f64>, by_frame: &DMatrix<f64>| {
        by_knots * &knots.covariance * by_knots.transpose()
            + by_frame * &frame.covariance * by_frame.transpose()
    };
    MotionInstant {
        time_s: *time_s,
        prisms: Arc::clone(&prisms.in_drive),
        position_m: prisms.of_vector(position_m),
        velocity_m_per_s: prisms.of_vector(velocity_m_per_s),
        position_covariance: prisms
            .rows_and_columns(covariance(&position_by_knots, &position_by_frame)),
        velocity_covariance: prisms
            .rows_and_columns(covariance(&velocity_by_knots, &velocity_by_frame)),
    }
}
