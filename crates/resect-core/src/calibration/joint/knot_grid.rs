//! Knots of the uniform cubic B-splines along which the prisms move, one grid for each segment of a drive.
//!
//! A segment is an unbroken span of time with at most [`MOST_KNOTS`] knots. It consists of blocks of equal length, in each of which
//! the slow states are constant.

use super::spans::Span;

/// Coefficients on which an instant depends. Textbook: the order of a cubic spline.
pub const ORDER: usize = 4;

/// The splines reach this far beyond their segments (s), because clock offsets shift the readings.
const MARGIN_S: f64 = 0.25;
/// Fewest knot intervals of a segment: shorter ones have too few readings for a motion.
pub const FEWEST_KNOTS: f64 = 4.0;
/// Longer spans are cut, so that segments are eliminated in parallel and their rows stay in the cache. The information that a cut
/// loses is negligible beside so many knots. [`super::cut_motion`] restores it where the motion itself is evaluated.
const MOST_KNOTS: f64 = 100.0;
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

/// The segments of a span, in blocks of about `block_s`.
pub fn segment_grids(span: &Span, knot_s: f64, block_s: f64) -> Vec<KnotGrid> {
    let Span { start_s, end_s, .. } = *span;
    let segments = ((end_s - start_s) / (MOST_KNOTS * knot_s)).ceil().max(1.0);
    // Whole knots apart, so that the motion across a cut has the knots of both sides.
    let cut_s = |k: f64| start_s + knot_s * ((end_s - start_s) * k / segments / knot_s).round();
    let block_s = block_s.max(BLOCK_KNOTS * knot_s);
    let grid = |k: usize| {
        // No instant is in two of them.
        let from_s = if k == 0 { start_s } else { cut_s(k as f64).next_up() };
        let to_s = if k as f64 + 1.0 < segments { cut_s(k as f64 + 1.0) } else { end_s };
        let blocks = ((to_s - from_s) / block_s).floor().max(1.0) as usize;
        KnotGrid::new([from_s, to_s], knot_s, blocks)
    };
    (0..segments as usize).map(grid).collect()
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

    /// Number of jerks.
    pub fn jerks(&self) -> usize {
        self.knots - (ORDER - 1)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn span(end_s: f64) -> Span {
        Span { start_s: 0.0, end_s, prisms: vec![0] }
    }

    #[test]
    fn a_line_is_reproduced_and_velocities_are_its_slope() {
        let grid = &segment_grids(&span(4.9), 0.4, 6.0)[0];
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
    fn a_long_span_is_cut_and_no_instant_is_in_two_segments() {
        let grids = segment_grids(&span(100.0), 0.4, 6.0);
        assert_eq!(grids.len(), 3);
        let (first, last) = (&grids[0], &grids[2]);
        assert_eq!((first.start_s, last.end_s), (0.0, 100.0));
        assert!(grids.windows(2).all(|pair| pair[1].start_s == pair[0].end_s.next_up()));
    }
}
