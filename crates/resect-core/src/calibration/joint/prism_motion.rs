//! Positions and velocities of the prisms at any instant of a solution, with their covariance.
//!
//! The motion is that of the splines. Its covariance combines that of four knots given the unknowns of their block
//! ([`super::knot_covariance`]) with that of the block's unknowns ([`super::chain_factor`]): transforms, clocks, instruments, and
//! stations that settle. An instant between two segments has no motion.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Matrix3, SMatrix, SVector, Vector3, Vector4};
use rayon::prelude::*;

use super::block_jacobians::station_1_shift_m;
use super::cut_motion::{CutMotion, cut_span_s, estimate_cut_motion};
use super::drive::Drive;
use super::gauss_newton_step::{GaussNewtonStep, RowBuffers};
use super::knot_covariance::{KnotCovariance, each_knot_covariance};
use super::knot_grid::{KnotGrid, ORDER, SplineWeights};
use super::linearisation::{Linearisation, Weighting};
use super::motion_band::{
    MotionBand, PRISM, PRISM_MOTION_ROW, PRISM_ROW, RIG, RIG_MOTION_ROW, RIG_ROW,
};
use super::priors::Priors;
use super::settling::station_1_by_relative;
use super::state_vector::{BLOCK, CONSTANTS, SLOW, StateVector};
use crate::calibration::ErrorSizes;
use crate::progress::{Cancelled, Progress};

/// The solution of an estimate, from which its motion is evaluated.
#[derive(Clone, Debug)]
pub struct Solution {
    pub(super) drive: Arc<Drive>,
    pub(super) state: StateVector,
    pub(super) weighting: Weighting,
    pub(super) priors: Priors,
    pub(super) sizes: ErrorSizes,
    pub(super) prisms: usize,
}

/// The prisms at one instant: x, y, z of each, in the frame of station 1 as it was set up.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionInstant<const N: usize> {
    pub time_s: f64,
    pub position_m: SVector<f64, N>,
    pub velocity_m_per_s: SVector<f64, N>,
    /// Covariances of the positions (m²), and of the velocities (m²/s²).
    pub position_covariance: SMatrix<f64, N, N>,
    pub velocity_covariance: SMatrix<f64, N, N>,
}

/// The instants within segments, in order of time.
#[derive(Clone, Debug, PartialEq)]
pub enum PrismMotion {
    /// Instants of the three prisms of a rig.
    Rig(Vec<MotionInstant<9>>),
    /// Instants of the one prism that all stations follow.
    Prism(Vec<MotionInstant<3>>),
}

/// Jacobian of positions by the constants of a drive, and the covariance of the constants.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConstantsJacobian {
    /// By time (s): a row for each coordinate of the prisms (m), a column for each constant.
    pub instants: Vec<(f64, DMatrix<f64>)>,
    pub covariance: DMatrix<f64>,
}

impl Solution {
    /// The motion at increasing times (s, stamps of station 1).
    pub fn instants(&self, time_s: &[f64], progress: &Progress) -> Result<PrismMotion, Cancelled> {
        Ok(if self.prisms == 3 {
            PrismMotion::Rig(self.instants_of::<RIG, RIG_ROW, RIG_MOTION_ROW>(time_s, progress)?)
        } else {
            PrismMotion::Prism(
                self.instants_of::<PRISM, PRISM_ROW, PRISM_MOTION_ROW>(time_s, progress)?,
            )
        })
    }

    /// Jacobian of the positions at increasing times by the constants: the errors that all instants have in common.
    pub fn constants_jacobian(
        &self,
        time_s: &[f64],
        progress: &Progress,
    ) -> Result<ConstantsJacobian, Cancelled> {
        if self.prisms == 3 {
            self.constants_jacobian_of::<RIG, RIG_ROW, RIG_MOTION_ROW>(time_s, progress)
        } else {
            self.constants_jacobian_of::<PRISM, PRISM_ROW, PRISM_MOTION_ROW>(time_s, progress)
        }
    }

    fn instants_of<const LOCAL: usize, const ROW: usize, const MOTION: usize>(
        &self,
        time_s: &[f64],
        progress: &Progress,
    ) -> Result<Vec<MotionInstant<LOCAL>>, Cancelled> {
        let Some(step) = self.linearise::<LOCAL, ROW>(progress)? else { return Ok(Vec::new()) };
        let frames = self.frames(&step);
        self.map_instants::<LOCAL, ROW, MOTION, _>(&step, time_s, progress, |instant| {
            motion_instant::<LOCAL>(&instant, &frames[instant.block])
        })
    }

    fn constants_jacobian_of<const LOCAL: usize, const ROW: usize, const MOTION: usize>(
        &self,
        time_s: &[f64],
        progress: &Progress,
    ) -> Result<ConstantsJacobian, Cancelled> {
        let Some(step) = self.linearise::<LOCAL, ROW>(progress)? else {
            return Ok(ConstantsJacobian::default());
        };
        let jacobians = &step.normal.matrix.jacobians;
        let instants =
            self.map_instants::<LOCAL, ROW, MOTION, _>(&step, time_s, progress, |at| {
                let mut frame_by_constants = SMatrix::<f64, FRAME, CONSTANTS>::zeros();
                let by_constants = jacobians.of_block(at.block).0;
                frame_by_constants.fixed_rows_mut::<BLOCK>(0).copy_from(&by_constants);
                let station_1_by_constants = jacobians.of_station_1(at.block).0;
                frame_by_constants.fixed_rows_mut::<6>(BLOCK).copy_from(&station_1_by_constants);
                let by_knots = jacobian_by_knots(LOCAL, &at.weights.position);
                let position_m =
                    &by_knots * DVector::from_column_slice(&at.knots_m[..ORDER * LOCAL]);
                let frame_by_constants =
                    DMatrix::from_column_slice(FRAME, CONSTANTS, frame_by_constants.as_slice());
                let by_frame =
                    jacobian_by_frame(&(by_knots * &at.covariance.by_block), &position_m);
                (at.time_s, by_frame * frame_by_constants)
            })?;
        let covariance = step.factor.constants_covariance();
        let covariance = DMatrix::from_column_slice(CONSTANTS, CONSTANTS, covariance.as_slice());
        Ok(ConstantsJacobian { instants, covariance })
    }

    fn linearise<const LOCAL: usize, const ROW: usize>(
        &self,
        progress: &Progress,
    ) -> Result<Option<GaussNewtonStep<LOCAL, ROW>>, Cancelled> {
        let Self { drive, state, weighting, priors, .. } = self;
        GaussNewtonStep::new(drive, state, weighting, priors, &mut RowBuffers::default(), progress)
    }

    /// Maps each of some increasing times that lies within a segment.
    fn map_instants<const LOCAL: usize, const ROW: usize, const MOTION: usize, T: Send>(
        &self,
        step: &GaussNewtonStep<LOCAL, ROW>,
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
            let motion =
                estimate_cut_motion::<LOCAL, ROW, MOTION>(&linearisation, &self.weighting, index);
            Ok(motion.map(|CutMotion { grid, coefficients_m, band }| {
                let last_block = linearisation.first_blocks[index + 1] - 1;
                (span_s, map_times(&grid, &coefficients_m, &band, (times_s, last_block), &map))
            }))
        };
        let cuts = (0..drive.segments.len()).into_par_iter().map(across_cut);
        let cuts: Vec<_> = cuts.collect::<Result<_, Cancelled>>()?;
        let (cut_spans_s, of_cuts): (Vec<_>, Vec<_>) = cuts.into_iter().map(Option::unzip).unzip();
        let of_segment = |index: usize, band: &MotionBand<LOCAL, ROW>| {
            let grid = &drive.segments[index].grid;
            let before = index.checked_sub(1).and_then(|k| cut_spans_s[k]);
            let after = cut_spans_s[index];
            let times_s = between(
                time_s,
                |t| t < grid.start_s || before.is_some_and(|span_s| t <= span_s[1]),
                |t| t > grid.end_s || after.is_some_and(|span_s| t >= span_s[0]),
            );
            let coefficients_m = &self.state.coefficients_m[index];
            let first_block = linearisation.first_blocks[index];
            map_times(grid, coefficients_m, band, (times_s, first_block), &map)
        };
        let of_segments = step.map_segments(&self.state, of_segment);
        progress.check()?;
        let mapped = of_segments.into_iter().zip(of_cuts).flat_map(|(own, cut)| [own, cut]);
        Ok(mapped.flatten().flatten().collect())
    }

    /// Positions of the prisms of a rig at an instant (s, stamps of station 1), in the frame of station 1 as it was set up (m).
    ///
    /// Returns `None` outside of all segments, and for one prism. This evaluates the splines without covariance, fast enough for each
    /// frame of a window. Unlike [`Self::instants`] it ignores the motion across cuts ([`super::cut_motion`]).
    pub fn prisms_m(&self, time_s: f64) -> Option<[Vector3<f64>; 3]> {
        let segments = &self.drive.segments;
        let index = segments.partition_point(|segment| segment.grid.end_s < time_s);
        let grid = &segments.get(index).filter(|_| self.prisms == 3)?.grid;
        if !grid.contains(time_s) {
            return None;
        }
        let first_block: usize = segments[..index].iter().map(|segment| segment.grid.blocks).sum();
        let slow = &self.state.slow[first_block + grid.block_at(time_s)];
        let settled =
            station_1_by_relative(&self.sizes, &self.priors.mean).0 * slow.fixed_rows::<8>(0);
        let mean_sight = &self.drive.mean_sights[first_block + grid.block_at(time_s)][0];
        let shift_m = station_1_shift_m(&self.state.constants, mean_sight, slow);
        let weights = grid.weights(time_s);
        let knots_m = &self.state.coefficients_m[index][9 * weights.first..];
        Some([0, 1, 2].map(|prism| {
            let knot_m = |k: usize| Vector3::from_column_slice(&knots_m[9 * k + 3 * prism..][..3]);
            let position_m =
                (0..ORDER).map(|k| weights.position[k] * knot_m(k)).sum::<Vector3<f64>>();
            as_set_up(&(position_m + shift_m), &settled)
        }))
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
    fn frames<const LOCAL: usize, const ROW: usize>(
        &self,
        step: &GaussNewtonStep<LOCAL, ROW>,
    ) -> Vec<BlockFrame> {
        let (station_1_by_slow, remaining) = station_1_by_relative(&self.sizes, &self.priors.mean);
        // Settling displaces along x, y, z and rotates about z.
        let by_settling = SMatrix::<f64, 6, 4>::from_fn(|row, component| {
            f64::from(row == if component < 3 { component } else { 5 })
        });
        let constants_covariance = step.factor.constants_covariance();
        let mut frames = vec![BlockFrame::default(); self.drive.block_times_s.len()];
        let shares = step.slow_precisions.variance_shares();
        let jacobians = &step.normal.matrix.jacobians;
        step.factor.each_covariance(|block, slow| {
            let (block_by_constants, block_by_slow) = jacobians.of_block(block);
            let (readings_by_constants, readings_by_slow) = jacobians.of_station_1(block);
            let mut by_constants = SMatrix::<f64, FRAME, CONSTANTS>::zeros();
            by_constants.fixed_rows_mut::<BLOCK>(0).copy_from(&block_by_constants);
            by_constants.fixed_rows_mut::<6>(BLOCK).copy_from(&readings_by_constants);
            let mut by_slow = SMatrix::<f64, FRAME, SLOW>::zeros();
            by_slow.fixed_rows_mut::<BLOCK>(0).copy_from(&block_by_slow);
            by_slow.fixed_rows_mut::<6>(BLOCK).copy_from(&readings_by_slow);
            let mut settling = by_slow.fixed_view_mut::<6, 8>(BLOCK, 0);
            settling += by_settling * station_1_by_slow;
            let across = by_constants * slow.with_constants.transpose() * by_slow.transpose();
            let mut covariance = by_constants * constants_covariance * by_constants.transpose()
                + by_slow * slow.own * by_slow.transpose()
                + across
                + across.transpose();
            let mut station_1 = covariance.fixed_view_mut::<6, 6>(BLOCK, BLOCK);
            station_1 += by_settling * remaining * by_settling.transpose() * shares[block];
            let settled = station_1_by_slow * self.state.slow[block].fixed_rows::<8>(0);
            let shift = readings_by_slow.fixed_rows::<3>(0) * self.state.slow[block];
            frames[block] = BlockFrame { shift_m: shift, settled, covariance };
        });
        frames
    }
}

/// Input of the evaluation at one instant.
struct InstantInput<'a> {
    time_s: f64,
    weights: SplineWeights,
    /// Coefficients from the first of the four knots on (m).
    knots_m: &'a [f64],
    covariance: &'a KnotCovariance,
    /// Index of the block in the drive.
    block: usize,
}

/// Maps some increasing times of a segment, whose first block has an index in the drive.
fn map_times<const LOCAL: usize, const ROW: usize, T>(
    grid: &KnotGrid,
    coefficients_m: &[f64],
    band: &MotionBand<LOCAL, ROW>,
    (times_s, first_block): (&[f64], usize),
    map: &impl Fn(InstantInput<'_>) -> T,
) -> Vec<T> {
    let mut remaining: Vec<(SplineWeights, f64)> =
        times_s.iter().map(|t| (grid.weights(*t), *t)).collect();
    let mut mapped = Vec::with_capacity(remaining.len());
    each_knot_covariance(band, |covariance| {
        let is_next = |(weights, _): &mut (SplineWeights, f64)| weights.first == covariance.first;
        while let Some((weights, time_s)) = remaining.pop_if(is_next) {
            let knots_m = &coefficients_m[LOCAL * weights.first..];
            let block = first_block + grid.block_at(time_s);
            mapped.push(map(InstantInput { time_s, weights, knots_m, covariance, block }));
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

/// Number of a frame's unknowns: those of the block, then displacement (m) and rotation (rad) of station 1 with its readings.
const FRAME: usize = BLOCK + 6;

/// Settling of station 1 until a block, and the covariance of the frame's unknowns.
#[derive(Clone)]
struct BlockFrame {
    /// Correction of station 1's slow errors in the positions (m).
    shift_m: Vector3<f64>,
    /// x, y, z (m) and yaw (rad) of station 1 since its set-up.
    settled: Vector4<f64>,
    covariance: SMatrix<f64, FRAME, FRAME>,
}

impl Default for BlockFrame {
    fn default() -> Self {
        let settled = Vector4::zeros();
        Self { shift_m: Vector3::zeros(), settled, covariance: SMatrix::zeros() }
    }
}

/// Jacobian of a spline's value by the coefficients of four knots, with the factor of each.
fn jacobian_by_knots(local: usize, factors: &[f64; ORDER]) -> DMatrix<f64> {
    let element = |i: usize, j: usize| if j % local == i { factors[j / local] } else { 0.0 };
    DMatrix::from_fn(local, ORDER * local, element)
}

/// Jacobian of prisms at a position (m) by the frame's unknowns, from that by the block's unknowns.
fn jacobian_by_frame(by_block: &DMatrix<f64>, position_m: &DVector<f64>) -> DMatrix<f64> {
    let mut jacobian = DMatrix::zeros(position_m.len(), FRAME);
    jacobian.view_mut((0, 0), (position_m.len(), BLOCK)).copy_from(by_block);
    for x in (0..position_m.len()).step_by(3) {
        let prism_m = Vector3::new(position_m[x], position_m[x + 1], position_m[x + 2]);
        jacobian.fixed_view_mut::<3, 3>(x, BLOCK).fill_with_identity();
        jacobian.fixed_view_mut::<3, 3>(x, BLOCK + 3).copy_from(&jacobian_by_rotation(&prism_m));
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

fn motion_instant<const LOCAL: usize>(
    input: &InstantInput<'_>,
    frame: &BlockFrame,
) -> MotionInstant<LOCAL> {
    let InstantInput { time_s, weights, knots_m, covariance: knots, .. } = input;
    let value = |factors: &[f64; ORDER]| {
        SVector::<f64, LOCAL>::from_fn(|i, _| {
            factors.iter().enumerate().map(|(k, factor)| factor * knots_m[LOCAL * k + i]).sum()
        })
    };
    let (spline_m, spline_m_per_s) = (value(&weights.position), value(&weights.velocity));
    let position_by_knots = jacobian_by_knots(LOCAL, &weights.position);
    let velocity_by_knots = jacobian_by_knots(LOCAL, &weights.velocity);
    let position_by_frame = jacobian_by_frame(
        &(&position_by_knots * &knots.by_block),
        &DVector::from_column_slice(spline_m.as_slice()),
    );
    let mut velocity_by_frame = DMatrix::zeros(LOCAL, FRAME);
    let velocity_by_block = &velocity_by_knots * &knots.by_block;
    velocity_by_frame.view_mut((0, 0), (LOCAL, BLOCK)).copy_from(&velocity_by_block);
    let (mut position_m, mut velocity_m_per_s) = (spline_m, spline_m_per_s);
    for x in (0..LOCAL).step_by(3) {
        let seen_m: Vector3<f64> = spline_m.fixed_rows::<3>(x).into_owned();
        let prism_m = as_set_up(&(seen_m + frame.shift_m), &frame.settled);
        position_m.fixed_rows_mut::<3>(x).copy_from(&prism_m);
        let prism_m_per_s: Vector3<f64> = spline_m_per_s.fixed_rows::<3>(x).into_owned();
        let rotated = jacobian_by_rotation(&prism_m_per_s);
        velocity_by_frame.fixed_view_mut::<3, 3>(x, BLOCK + 3).copy_from(&rotated);
        let by_yaw = Vector3::z().cross(&prism_m_per_s);
        for axis in 0..3 {
            velocity_m_per_s[x + axis] += frame.settled[3] * by_yaw[axis];
        }
    }
    let frame_covariance = DMatrix::from_column_slice(FRAME, FRAME, frame.covariance.as_slice());
    let covariance = |by_knots: &DMatrix<f64>, by_frame: &DMatrix<f64>| {
        let total = by_knots * &knots.covariance * by_knots.transpose()
            + by_frame * &frame_covariance * by_frame.transpose();
        SMatrix::<f64, LOCAL, LOCAL>::from_column_slice(total.as_slice())
    };
    MotionInstant {
        time_s: *time_s,
        position_m,
        velocity_m_per_s,
        position_covariance: covariance(&position_by_knots, &position_by_frame),
        velocity_covariance: covariance(&velocity_by_knots, &velocity_by_frame),
    }
}
