//! The motion across the cuts between segments.
//!
//! Both sides of a cut are estimated independently, each from its own readings: near the cut the motion is twice as uncertain as
//! elsewhere, and has a jump. Nothing else in the estimate depends on that. Once the estimate is solved, the motion across the cut is
//! estimated again from the readings of both sides, and used for instants near it.

use std::sync::Arc;

use nalgebra::DVector;

use super::drive::{Drive, Segment};
use super::equations::{BlockUnknowns, RobustWeights, SegmentEquations};
use super::knot_grid::KnotGrid;
use super::linearisation::{Linearisation, Weighting, eliminate_motion};
use super::motion_band::{MotionBand, Rows};

/// The motion across a cut is used for this many knots on either side; its ends are as far away again.
const USED_KNOTS: f64 = 8.0;
/// Robust weights within this many knots of a cut are re-estimated.
const REWEIGHTED_KNOTS: f64 = 4.0;
/// Steps from the motion of both sides while weights are re-estimated.
const REWEIGHTED_STEPS: usize = 4;
/// Further steps with fixed weights.
const FIXED_STEPS: usize = 2;

/// The motion across a cut.
pub struct CutMotion {
    /// The readings near the cut, on a grid across it.
    pub segment: Segment,
    pub coefficients_m: Vec<f64>,
    pub band: MotionBand,
}

/// Start and end of the motion across the cut after a segment (s); `None` without a cut.
pub fn cut_span_s(drive: &Drive, index: usize) -> Option<[f64; 2]> {
    let [segment, next] = [index, index + 1].map(|k| drive.segments.get(k));
    let (segment, next) = (segment?, next?);
    let (grid, half_s) = (&segment.grid, USED_KNOTS * segment.grid.knot_s);
    grid.across_cut(&next.grid).filter(|_| Arc::ptr_eq(&segment.prisms, &next.prisms))?;
    Some([grid.end_s - half_s, grid.end_s + half_s])
}

/// Estimates the motion across the cut after a segment, everything else being constant; `None` without a cut, or if the normal matrix
/// is not positive definite.
pub fn estimate_cut_motion(
    linearisation: &Linearisation<'_>,
    weighting: &Weighting,
    index: usize,
) -> Option<CutMotion> {
    let sides = linearisation.drive.segments.get(index..index + 2)?;
    let grid = sides[0].grid.across_cut(&sides[1].grid)?;
    let readings = sides[0].readings.zip(&sides[1].readings, |before, after| {
        let both = before.iter().chain(after.iter());
        let near = both.filter(|reading| grid.contains(reading.time_s));
        near.cloned().collect::<Vec<_>>().into()
    });
    let mut coefficients_m = initial_coefficients_m(linearisation, &grid, index);
    let prisms = Arc::clone(&sides[0].prisms);
    let excess_jerks = linearisation.drive.excess_jerks(&grid);
    let segment = Segment { grid, prisms, readings, excess_jerks, middle_s: sides[0].middle_s };
    // The last block before the cut, and the first after it.
    let next = linearisation.first_blocks[index + 1];
    let blocks = next - 1..next + 1;
    let mut rows = Rows::default();
    let mut fixed: Option<RobustWeights> = None;
    for step in 0..REWEIGHTED_STEPS + FIXED_STEPS {
        let point = linearisation.point(&segment, blocks.clone(), &coefficients_m);
        let own = weighting.with_fixed(fixed.as_ref());
        let SegmentEquations { band, weights, .. } = eliminate_motion(
            &segment,
            &point,
            &own,
            BlockUnknowns::Constant,
            std::mem::take(&mut rows),
        )?;
        let step_m = band.motion_step(&[]);
        coefficients_m.iter_mut().zip(&step_m).for_each(|(value, step_m)| *value -= step_m);
        rows = band.into_rows();
        if step + 1 == REWEIGHTED_STEPS {
            let of_sides = weighting.fixed.as_ref().map(|fixed| &fixed[index..]);
            fixed = Some(with_weights_of_sides(weights, sides, of_sides, &segment));
        }
    }
    let point = linearisation.point(&segment, blocks, &coefficients_m);
    let own = weighting.with_fixed(fixed.as_ref());
    let SegmentEquations { band, .. } =
        eliminate_motion(&segment, &point, &own, BlockUnknowns::Border, Rows::default())?;
    Some(CutMotion { segment, coefficients_m, band })
}

/// Replaces the weights beyond [`REWEIGHTED_KNOTS`] by those of the sides, so that the motions agree there. Nearer to the cut each side
/// saw only half of the readings.
fn with_weights_of_sides(
    weights: RobustWeights,
    sides: &[Segment],
    of_sides: Option<&[RobustWeights]>,
    segment: &Segment,
) -> RobustWeights {
    let Some(of_sides) = of_sides else { return weights };
    let mut weights = weights.to_vec();
    let cut_s = sides[0].grid.end_s;
    let is_far = |time_s: f64| (time_s - cut_s).abs() > REWEIGHTED_KNOTS * segment.grid.knot_s;
    let mut remaining = weights.iter_mut();
    let mut first = [0; 2];
    for station in segment.readings.numbers() {
        for (side, (own, of_side)) in sides.iter().zip(of_sides).enumerate() {
            let readings = &own.readings[station];
            let weighted = readings.iter().zip(&of_side[first[side]..]);
            let near = weighted.filter(|(reading, _)| segment.grid.contains(reading.time_s));
            // The segment's readings have the same order.
            for ((reading, of_side), weight) in near.zip(remaining.by_ref()) {
                if is_far(reading.time_s) {
                    *weight = *of_side;
                }
            }
            first[side] += readings.len();
        }
    }
    for (jerk, weight) in remaining.enumerate() {
        let time_s = segment.grid.jerk_time_s(jerk);
        let side = usize::from(time_s > cut_s);
        let of_jerks = &of_sides[side][first[side]..];
        let index = sides[side].grid.weights(time_s).first;
        if let Some(of_side) = of_jerks.get(index).filter(|_| is_far(time_s)) {
            *weight = *of_side;
        }
    }
    weights.into()
}

/// Coefficients of splines through the motion on both sides of the cut after a segment (m).
fn initial_coefficients_m(
    linearisation: &Linearisation<'_>,
    grid: &KnotGrid,
    index: usize,
) -> Vec<f64> {
    let cut_s = linearisation.drive.segments[index].grid.end_s;
    let local = linearisation.drive.segments[index].prisms.coordinates();
    let position_m = |time_s: f64| -> DVector<f64> {
        let side = if time_s <= cut_s { index } else { index + 1 };
        let weights = linearisation.drive.segments[side].grid.weights(time_s);
        let knots_m = &linearisation.state.coefficients_m[side][local * weights.first..];
        DVector::from_fn(local, |i, _| {
            let factors = weights.position.iter().enumerate();
            factors.map(|(k, factor)| factor * knots_m[local * k + i]).sum()
        })
    };
    let mut coefficients_m = Vec::with_capacity(local * grid.knots);
    for knot in 0..grid.knots {
        let time_s = grid.knot_time_s(knot);
        // A spline differs from its coefficients by its curvature (Schoenberg 1946).
        let [before, at, after] = [-1.0, 0.0, 1.0].map(|k| position_m(time_s + k * grid.knot_s));
        coefficients_m.extend((&at - (before - 2.0 * &at + after) / 6.0).iter());
    }
    coefficients_m
}
