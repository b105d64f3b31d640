//! Knots of the uniform cubic B-splines along which the prisms move, one grid for each segment of a drive.
//!
//! A segment is an unbroken span of time with at most [`MOST_KNOTS`] knots. It consists of blocks of equal length, in each of which
//! the slow states are constant.

use std::ops::Range;

use crate::statistics::median;

/// Coefficients on which an instant depends. Textbook: the order of a cubic spline.
pub const ORDER: usize = 4;

/// The splines reach this far beyond their segments (s), because clock offsets shift the readings.
const MARGIN_S: f64 = 0.25;
/// Segments of fewer knots are left out: they have too few readings for a motion.
const FEWEST_KNOTS: f64 = 4.0;
/// Longer spans are cut, so that segments are eliminated in parallel and their rows stay in the cache. The information that a cut
/// loses is negligible beside so many knots. [`super::cut_motion`] restores it where the motion itself is evaluated.
const MOST_KNOTS: f64 = 100.0;
/// A gap longer than this many median steps ends a segment.
const STEPS_APART: f64 = 2.5;
/// The slow states are constant for at least this many knots.
const BLOCK_KNOTS: f64 = 16.0;

/// Knots and blocks of one segment.
#[derive(Clone, Debug, PartialEq)]
pub struct KnotGrid {
    pub start_s: f64,
    pub end_s: f64,
    /// Time between knots (s).
    pub knot_s: f64,
    pub knots: usize,
    /// Number of blocks.
    pub blocks: usize,
}

/// Weights of the four coefficients from `first` on in the position, and in the velocity (1/s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplineWeights {
    pub first: usize,
    pub position: [f64; ORDER],
    pub velocity: [f64; ORDER],
}

/// The segments of consecutive instants of the same interval, in blocks of about `block_s`; what is too short is left out.
pub fn segment_grids(time_s: &[f64], interval: &[u32], knot_s: f64, block_s: f64) -> Vec<KnotGrid> {
    let gap_s = STEPS_APART * median(time_s.windows(2).map(|w| w[1] - w[0])).unwrap_or(1.0);
    unbroken(time_s, interval, gap_s)
        .into_iter()
        .map(|range| (time_s[range.start], time_s[range.end - 1]))
        .filter(|(start_s, end_s)| end_s - start_s >= FEWEST_KNOTS * knot_s)
        .flat_map(|(start_s, end_s)| {
            let segments = ((end_s - start_s) / (MOST_KNOTS * knot_s)).ceil().max(1.0);
            let cut_s = move |k: f64| start_s + (end_s - start_s) * k / segments;
            // No instant is in two of them.
            (0..segments as usize).map(move |k| match k as f64 {
                0.0 => (start_s, if segments > 1.0 { cut_s(1.0) } else { end_s }),
                k if k + 1.0 < segments => (cut_s(k).next_up(), cut_s(k + 1.0)),
                k => (cut_s(k).next_up(), end_s),
            })
        })
        .map(|(start_s, end_s)| {
            let block_s = block_s.max(BLOCK_KNOTS * knot_s);
            let blocks = ((end_s - start_s) / block_s).floor().max(1.0) as usize;
            KnotGrid::new([start_s, end_s], knot_s, blocks)
        })
        .collect()
}

impl KnotGrid {
    fn new([start_s, end_s]: [f64; 2], knot_s: f64, blocks: usize) -> Self {
        let knots = ((end_s - start_s + 2.0 * MARGIN_S) / knot_s).ceil() as usize + 3;
        Self { start_s, end_s, knot_s, knots, blocks }
    }

    /// Returns a grid of one block on either side of the cut between this segment and the next; `None` unless they meet.
    pub fn across_cut(&self, next: &Self) -> Option<Self> {
        // No block is shorter, so each half lies within one.
        let half_s = BLOCK_KNOTS * self.knot_s;
        let (from_s, to_s) = (self.end_s - half_s, self.end_s + half_s);
        (next.start_s == self.end_s.next_up()).then(|| Self::new([from_s, to_s], self.knot_s, 2))
    }

    /// Returns the weights at an instant, at most [`MARGIN_S`] outside of the segment.
    pub fn weights(&self, time_s: f64) -> SplineWeights {
        let along = (time_s - self.start_s + MARGIN_S) / self.knot_s;
        let along = along.clamp(0.0, (self.knots - 3) as f64 - 1e-9);
        let (first, u) = (along as usize, along.fract());
        let v = 1.0 - u;
        let cubic = |u: f64| (3.0 * u - 6.0) * u * u + 4.0;
        let quadratic = |u: f64| (9.0 * u - 12.0) * u;
        let rate = 1.0 / (6.0 * self.knot_s);
        SplineWeights {
            first,
            position: [v * v * v, cubic(u), cubic(v), u * u * u].map(|w| w / 6.0),
            velocity: [-3.0 * v * v, quadratic(u), -quadratic(v), 3.0 * u * u].map(|w| w * rate),
        }
    }

    /// Time at which a knot's basis spline is highest (s).
    pub fn knot_time_s(&self, knot: usize) -> f64 {
        self.start_s - MARGIN_S + (knot as f64 - 1.0) * self.knot_s
    }

    /// Time in the middle of four knots from `first` on (s), of which a jerk is the third difference.
    pub fn jerk_time_s(&self, first: usize) -> f64 {
        self.knot_time_s(first) + 1.5 * self.knot_s
    }

    /// Returns true for an instant within the segment.
    pub fn contains(&self, time_s: f64) -> bool {
        (self.start_s..=self.end_s).contains(&time_s)
    }

    fn block_s(&self) -> f64 {
        (self.end_s - self.start_s) / self.blocks as f64
    }

    /// Returns the block that an instant is in.
    pub fn block_at(&self, time_s: f64) -> usize {
        (((time_s - self.start_s) / self.block_s()).max(0.0) as usize).min(self.blocks - 1)
    }

    /// Time in the middle of a block (s).
    pub fn block_time_s(&self, block: usize) -> f64 {
        self.start_s + (block as f64 + 0.5) * self.block_s()
    }

    /// The first knot that each block's readings act on, as far as their clocks may be off.
    pub fn first_knots(&self) -> Vec<usize> {
        let begins_s = |block: usize| self.start_s + block as f64 * self.block_s() - MARGIN_S;
        (0..self.blocks)
            .map(|block| if block == 0 { 0 } else { self.weights(begins_s(block)).first })
            .collect()
    }
}

fn unbroken(time_s: &[f64], interval: &[u32], gap_s: f64) -> Vec<Range<usize>> {
    let mut ranges = Vec::new();
    let mut start = 0;
    for i in 1..=time_s.len() {
        if i == time_s.len() || interval[i] != interval[start] || time_s[i] - time_s[i - 1] > gap_s
        {
            ranges.push(start..i);
            start = i;
        }
    }
    ranges
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_reproduced_and_velocities_are_its_slope() {
        let time_s: Vec<f64> = (0..50).map(|i| f64::from(i) * 0.1).collect();
        let grid = &segment_grids(&time_s, &[0; 50], 0.4, 6.0)[0];
        let knot = |k: usize| 2.0 * grid.knot_time_s(k) - 1.0;
        for time_s in [-0.2, 0.0, 0.13, 2.0, 4.9, 5.1] {
            let place = grid.weights(time_s);
            let sum = |w: &[f64; 4]| (0..4).map(|k| w[k] * knot(place.first + k)).sum::<f64>();
            assert!((sum(&place.position) - (2.0 * time_s - 1.0)).abs() < 1e-12, "{time_s}");
            assert!((sum(&place.velocity) - 2.0).abs() < 1e-12, "{time_s}");
            let (before, after) = (grid.weights(time_s - 1e-6), grid.weights(time_s + 1e-6));
            if before.first == after.first {
                for k in 0..4 {
                    let slope = (after.position[k] - before.position[k]) / 2e-6;
                    assert!((slope - place.velocity[k]).abs() < 1e-6, "{time_s} {k}");
                }
            }
        }
    }

    #[test]
    fn a_gap_or_another_interval_ends_a_segment() {
        let time_s = [0.0, 0.1, 0.2, 5.0, 5.1, 5.2, 5.3, 9.0];
        let segment_grids = segment_grids(&time_s, &[0, 0, 0, 0, 0, 1, 1, 1], 0.02, 6.0);
        let ends: Vec<_> = segment_grids.iter().map(|s| (s.start_s, s.end_s)).collect();
        assert_eq!(ends, [(0.0, 0.2), (5.0, 5.1), (5.2, 5.3)]);
    }
}
