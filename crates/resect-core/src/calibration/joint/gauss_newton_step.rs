//! One Gauss–Newton step: linearisation of all segments, elimination of the motion, solution of the chain, back substitution.

use std::mem::take;
use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::block_jacobians::BlockJacobians;
use super::chain::{ChainEquations, ChainMatrix, ChainVector};
use super::chain_factor::ChainFactor;
use super::drive::Drive;
use super::equations::{
    BlockUnknowns, ResidualSquares, RobustWeights, SegmentEquations, SegmentWeighting,
};
use super::gradients::gradients;
use super::linearisation::{Linearisation, Weighting, eliminate_motion};
use super::motion_band::{BlockEquations, MotionBand, Rows};
use super::priors::Priors;
use super::random_walks::SlowPrecisions;
use super::residuals::NoiseLevels;
use super::state_vector::{BlockVector, Constants, Slow, StateVector};
use super::trace::{SolverPhase, TraceRow};
use crate::progress::{Cancelled, Progress};

/// Memory for the rows of each segment, reused by the next step: allocating it takes as long as filling it.
pub type RowBuffers = Vec<Rows>;

/// The normal equations at a state, and their solution.
pub struct GaussNewtonStep {
    pub segments: Vec<SegmentEquations>,
    /// Noise levels of the linearisation, with which rows that are not stored are recomputed.
    pub levels: NoiseLevels,
    pub normal: ChainEquations,
    pub slow_precisions: SlowPrecisions,
    pub factor: ChainFactor,
    /// The step of constants and slow states, to be subtracted.
    pub step: ChainVector,
    /// Squared length of the step in units of the data's information (σ²), by which convergence is judged.
    pub squared_length: f64,
    /// True if the normal matrix is positive definite only with tighter priors of slow states, so that σ is too small.
    pub is_stiffer: bool,
}

impl GaussNewtonStep {
    /// Linearises at a state and solves; `None` if a normal matrix is not positive definite.
    pub fn new(
        drive: &Arc<Drive>,
        state: &StateVector,
        weighting: &Weighting,
        priors: &Priors,
        buffers: &mut RowBuffers,
        progress: &Progress,
    ) -> Result<Option<Self>, Cancelled> {
        let jacobians = BlockJacobians::new(drive, &state.constants);
        let linearisation = Linearisation::new(state, &jacobians);
        let stored = drive.stored_segments();
        buffers.resize_with(drive.segments.len(), Rows::default);
        let eliminate = |shared: &mut Rows, (index, own): (usize, &mut Rows)| {
            progress.check()?;
            let rows = if index < stored { own } else { shared };
            let (segment, point) = linearisation.segment(index);
            let mut eliminated = eliminate_motion(
                segment,
                &point,
                &weighting.of_segment(index),
                BlockUnknowns::Border,
                take(rows),
            );
            if let Some(eliminated) = eliminated.as_mut().filter(|_| index >= stored) {
                *rows = eliminated.band.take_rows();
            }
            Ok(eliminated)
        };
        let segments = buffers.par_iter_mut().enumerate().map_init(Rows::default, eliminate);
        let segments: Vec<_> = segments.collect::<Result<_, Cancelled>>()?;
        let Some(mut segments) = segments.into_iter().collect::<Option<Vec<_>>>() else {
            return Ok(None);
        };
        let mut blocks: Vec<BlockEquations> = Vec::with_capacity(drive.block_times_s.len());
        segments.iter_mut().for_each(|segment| blocks.extend(take(&mut segment.band.blocks)));
        let matrix = ChainMatrix::new(blocks, jacobians);
        let gradient = matrix.gradient(matrix.block_gradients());
        let normal = ChainEquations { matrix: Arc::new(matrix), gradient };
        progress.check()?;
        let solution = solve_chain(&normal, state, priors);
        Ok(solution.map(|solution| Self {
            segments,
            levels: weighting.levels,
            normal,
            slow_precisions: solution.slow_precisions,
            factor: solution.factor,
            step: solution.step,
            squared_length: solution.squared_length,
            is_stiffer: solution.is_stiffer,
        }))
    }

    /// Robust weights by segment.
    pub fn weights(&self) -> Vec<RobustWeights> {
        self.segments.iter().map(|segment| Arc::clone(&segment.weights)).collect()
    }

    /// Returns the memory of the rows.
    pub fn into_buffers(self) -> RowBuffers {
        self.segments.into_iter().map(|segment| segment.band.into_rows()).collect()
    }

    /// Solves the same equations with other priors; `None` if the normal matrix is not positive definite.
    pub fn solve_again(&mut self, state: &StateVector, priors: &Priors) -> Option<()> {
        let solution = solve_chain(&self.normal, state, priors)?;
        (self.slow_precisions, self.factor) = (solution.slow_precisions, solution.factor);
        (self.step, self.squared_length) = (solution.step, solution.squared_length);
        self.is_stiffer = solution.is_stiffer;
        Some(())
    }

    /// Returns the row of this whole step in the trace, without cost.
    pub fn trace_row(&self, phase: SolverPhase) -> TraceRow {
        let (mut readings, mut downweighted) = (0, 0);
        for (eliminated, segment) in self.segments.iter().zip(&self.normal.drive().segments) {
            let count: usize = segment.readings.iter().map(|readings| readings.len()).sum();
            readings += count;
            // The weights of jerks follow those of readings.
            downweighted += eliminated.weights[..count].iter().filter(|it| **it < 0.5).count();
        }
        TraceRow {
            phase,
            squared_length: Some(self.squared_length),
            downweighted: Some(downweighted as f64 / readings.max(1) as f64),
            ..TraceRow::of_motion(self.levels)
        }
    }

    /// The weighting with which a segment was eliminated; nothing else depends on the redundancy then.
    fn weighting_of<'a>(&self, segment: &'a SegmentEquations) -> SegmentWeighting<'a> {
        SegmentWeighting { levels: self.levels, redundancy: 1.0, fixed: Some(&segment.weights) }
    }

    /// Computes the step from a state nearby, by the gradient there and the same normal matrix.
    pub fn update_gradient(
        &mut self,
        state: &StateVector,
        priors: &Priors,
        progress: &Progress,
    ) -> Result<(), Cancelled> {
        let linearisation = Linearisation::new(state, &self.normal.matrix.jacobians);
        let levels = &self.levels;
        let segments = self.segments.par_iter_mut().enumerate();
        let block_gradients = segments.map(|(index, eliminated)| {
            progress.check()?;
            let (segment, point) = linearisation.segment(index);
            let sums = gradients(segment, &point, levels, &eliminated.weights);
            Ok(eliminated.band.replace_gradient(sums.knots, sums.blocks))
        });
        let block_gradients: Vec<Vec<BlockVector>> =
            block_gradients.collect::<Result<_, Cancelled>>()?;
        self.normal.gradient = self.normal.matrix.gradient(block_gradients.into_iter().flatten());
        let right = self.normal.gradient_with_priors(priors, &self.slow_precisions, state);
        self.step = self.factor.solve_one(&right);
        self.squared_length = squared_length(&self.factor, &self.step, &right, priors);
        Ok(())
    }

    /// Step of each constant (σ).
    pub fn step_sigmas(&self) -> Constants {
        let variance = self.factor.constants_covariance().diagonal();
        let of_one =
            |step: f64, variance: f64| if variance > 0.0 { step / variance.sqrt() } else { 0.0 };
        self.step.constants.zip_map(&variance, of_one)
    }

    /// Largest step of a constant (σ).
    pub fn largest_step_sigmas(&self) -> f64 {
        self.step_sigmas().amax()
    }

    /// Maps the eliminated motion of some segments, recomputing rows that are not stored; `None` where that fails.
    pub fn map_segments<T: Send>(
        &self,
        state: &StateVector,
        segments: Range<usize>,
        map: impl Fn(usize, &MotionBand) -> T + Sync,
    ) -> Vec<Option<T>> {
        let linearisation = Linearisation::new(state, &self.normal.matrix.jacobians);
        let map_one = |rows: &mut Rows, index: usize| {
            let eliminated = &self.segments[index];
            if eliminated.band.has_rows() {
                return Some(map(index, &eliminated.band));
            }
            let (segment, point) = linearisation.segment(index);
            let weighting = self.weighting_of(eliminated);
            let again =
                eliminate_motion(segment, &point, &weighting, BlockUnknowns::Border, take(rows))?;
            let mapped = map(index, &again.band);
            *rows = again.band.into_rows();
            Some(mapped)
        };
        segments.into_par_iter().map_init(Rows::default, map_one).collect()
    }

    /// Cost of data, priors and survey at the state of the linearisation (σ²).
    pub fn cost(&self, state: &StateVector, priors: &Priors) -> f64 {
        let of_block = |(block, slow): (usize, &Slow)| {
            slow.dot(&self.slow_precisions.multiply(&state.slow, block))
        };
        let slow: f64 = state.slow.iter().enumerate().map(of_block).sum();
        let data: f64 = self.segments.iter().map(|segment| segment.cost).sum();
        data + slow + priors.cost(&state.constants) // (14)
    }

    /// Subtracts the step from a state, with back substitution of the motion. Constants and slow states take this share of their step,
    /// to which the motion is fitted. Recomputes rows that are not stored.
    pub fn apply(&self, state: &mut StateVector, share: f64) {
        let step = &self.step.scaled(share);
        let block_step = |block: usize| -> BlockVector {
            let (by_constants, by_slow) = self.normal.matrix.jacobians.of_block(block);
            by_constants * &step.constants + by_slow * &step.slow[block] // (19)
        };
        let mut all_m = take(&mut state.coefficients_m);
        let linearisation = Linearisation::new(state, &self.normal.matrix.jacobians);
        let apply = |rows: &mut Rows, (index, own_m): (usize, &mut Vec<f64>)| {
            let eliminated = &self.segments[index];
            let block_steps: Vec<BlockVector> =
                linearisation.blocks(index).map(block_step).collect();
            let motion_step = if eliminated.band.has_rows() {
                eliminated.band.motion_step(&block_steps)
            } else {
                let (segment, point) = linearisation.segment_with(index, own_m);
                let weighting = self.weighting_of(eliminated);
                let unknowns = BlockUnknowns::Step(&block_steps);
                let again = eliminate_motion(segment, &point, &weighting, unknowns, take(rows));
                // The same matrix was positive definite before.
                let Some(again) = again else { return };
                let motion_step = again.band.motion_step(&[]);
                *rows = again.band.into_rows();
                motion_step
            };
            own_m.iter_mut().zip(&motion_step).for_each(|(value, step)| *value -= step);
        };
        all_m.par_iter_mut().enumerate().for_each_init(Rows::default, apply);
        state.coefficients_m = all_m;
        state.constants -= &step.constants;
        state.slow.iter_mut().zip(&step.slow).for_each(|(slow, step)| *slow -= step);
    }
}

struct ChainSolution {
    slow_precisions: SlowPrecisions,
    factor: ChainFactor,
    step: ChainVector,
    squared_length: f64,
    is_stiffer: bool,
}

/// Solves the normal equations with the priors; `None` if the matrix is not positive definite.
fn solve_chain(
    normal: &ChainEquations,
    state: &StateVector,
    priors: &Priors,
) -> Option<ChainSolution> {
    let slow_precisions = SlowPrecisions::of_drive(&priors.slow, normal.drive())?;
    let right = normal.gradient_with_priors(priors, &slow_precisions, state);
    let solve = |precisions: &SlowPrecisions| {
        ChainFactor::new(&normal.matrix, &priors.information(), precisions, &right)
    };
    // Far from the solution the slow states may be unobservable, and are constrained.
    let solved = solve(&slow_precisions);
    let is_stiffer = solved.is_none();
    let (factor, step) = solved.or_else(|| solve(&slow_precisions.stiffer()))?;
    let squared_length = squared_length(&factor, &step, &right, priors);
    Some(ChainSolution { slow_precisions, factor, step, squared_length, is_stiffer })
}

/// Returns the squared length of a step by the normal matrix of data and survey: its product with the right-hand side less the priors' part.
fn squared_length(
    factor: &ChainFactor,
    step: &ChainVector,
    right: &ChainVector,
    priors: &Priors,
) -> f64 {
    let by_data = &right.constants - priors.own_information() * &step.constants;
    let of_block = |(block, slow): (usize, &Slow)| {
        slow.dot(&(&right.slow[block] - factor.priors.multiply(&step.slow, block)))
    };
    step.constants.dot(&by_data) + step.slow.iter().enumerate().map(of_block).sum::<f64>() // (21)
}

/// Takes one step of the motion alone, and returns the squared residuals before it; `None` if a normal matrix is not positive definite.
pub fn step_motion(
    drive: &Arc<Drive>,
    state: &mut StateVector,
    weighting: &Weighting,
    progress: &Progress,
) -> Result<Option<ResidualSquares>, Cancelled> {
    let jacobians = BlockJacobians::new(drive, &state.constants);
    let linearisation = Linearisation::new(state, &jacobians);
    let step = |rows: &mut Rows, index: usize| {
        progress.check()?;
        let (segment, point) = linearisation.segment(index);
        let weighting = weighting.of_segment(index);
        let eliminated =
            eliminate_motion(segment, &point, &weighting, BlockUnknowns::Constant, take(rows));
        let Some(eliminated) = eliminated else {
            return Ok(None);
        };
        let step = eliminated.band.motion_step(&[]);
        *rows = eliminated.band.into_rows();
        Ok(Some((step, eliminated.squares)))
    };
    let indices = (0..drive.segments.len()).into_par_iter();
    let steps: Vec<_> = indices.map_init(Rows::default, step).collect::<Result<_, Cancelled>>()?;
    let Some(steps) = steps.into_iter().collect::<Option<Vec<_>>>() else { return Ok(None) };
    let mut squares = ResidualSquares::zeros(drive.layout.stations());
    for (coefficients_m, (step, own)) in state.coefficients_m.iter_mut().zip(&steps) {
        coefficients_m.iter_mut().zip(step).for_each(|(value, step)| *value -= step);
        squares.add(own);
    }
    Ok(Some(squares))
}
