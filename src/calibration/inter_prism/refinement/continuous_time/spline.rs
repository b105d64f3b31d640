//! Uniform cubic B-splines: the motion of the three prisms over the spans that the triplets cover.

use std::ops::Range;

/// Coefficients of one knot: x, y, z of the three prisms, in station 1's frame (m).
pub const PER_KNOT: usize = 9;
/// Clocks may be off by this much (s); the splines reach as far beyond their spans.
const MARGIN_S: f64 = 0.25;
/// Shorter spans than this many knots hold too few readings for a motion.
const FEWEST_KNOTS: f64 = 4.0;
/// Triplets further apart than this many of their own steps belong to different spans.
const STEPS_APART: f64 = 2.5;

/// One unbroken stretch of the drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    pub start_s: f64,
    pub end_s: f64,
    /// First knot among those of all spans.
    pub first_knot: usize,
    pub knots: usize,
}

/// The spans of a drive, with knots this far apart (s).
#[derive(Clone, Debug, PartialEq)]
pub struct Spans {
    pub knot_s: f64,
    pub spans: Vec<Span>,
}

/// Four knots from `first` on, with what each adds to the position and to the velocity (1/s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    pub first: usize,
    pub position: [f64; 4],
    pub velocity: [f64; 4],
}

impl Spans {
    /// Over consecutive instants of the same interval; what is too short is left out.
    pub fn of(time_s: &[f64], interval: &[u32], knot_s: f64) -> Self {
        let mut steps_s: Vec<f64> = time_s.windows(2).map(|w| w[1] - w[0]).collect();
        steps_s.sort_by(f64::total_cmp);
        let apart_s = STEPS_APART * steps_s.get(steps_s.len() / 2).copied().unwrap_or(1.0);
        let mut spans: Vec<Span> = Vec::new();
        let mut first_knot = 0;
        for range in unbroken(time_s, interval, apart_s) {
            let (start_s, end_s) = (time_s[range.start], time_s[range.end - 1]);
            if end_s - start_s < FEWEST_KNOTS * knot_s {
                continue;
            }
            let length_s = end_s - start_s + 2.0 * MARGIN_S;
            let knots = (length_s / knot_s).ceil() as usize + 3;
            spans.push(Span { start_s, end_s, first_knot, knots });
            first_knot += knots;
        }
        Self { knot_s, spans }
    }

    pub fn knots(&self) -> usize {
        self.spans.last().map_or(0, |span| span.first_knot + span.knots)
    }

    /// The span that an instant belongs to.
    pub fn at(&self, time_s: f64) -> Option<&Span> {
        let index = self.spans.partition_point(|span| span.end_s < time_s);
        self.spans.get(index).filter(|span| span.start_s <= time_s)
    }

    /// What the knots of a span add at an instant, at most the margin outside of it.
    pub fn place(&self, span: &Span, time_s: f64) -> Place {
        let along = (time_s - span.start_s + MARGIN_S) / self.knot_s;
        let along = along.clamp(0.0, (span.knots - 3) as f64 - 1e-9);
        let (index, u) = (along as usize, along.fract());
        let v = 1.0 - u;
        let cubic = |u: f64| (3.0 * u - 6.0) * u * u + 4.0;
        let quadratic = |u: f64| (9.0 * u - 12.0) * u;
        let rate = 1.0 / (6.0 * self.knot_s);
        Place {
            first: span.first_knot + index,
            position: [v * v * v, cubic(u), cubic(v), u * u * u].map(|w| w / 6.0),
            velocity: [-3.0 * v * v, quadratic(u), -quadratic(v), 3.0 * u * u].map(|w| w * rate),
        }
    }
}

impl Span {
    /// When a knot's own spline is at its highest (s).
    pub fn knot_time_s(&self, knot: usize, knot_s: f64) -> f64 {
        self.start_s - MARGIN_S + (knot as f64 - 1.0) * knot_s
    }
}

fn unbroken(time_s: &[f64], interval: &[u32], apart_s: f64) -> Vec<Range<usize>> {
    let mut ranges = Vec::new();
    let mut start = 0;
    for i in 1..=time_s.len() {
        if i == time_s.len()
            || interval[i] != interval[start]
            || time_s[i] - time_s[i - 1] > apart_s
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
    fn a_line_is_met_exactly_and_velocities_are_the_differences() {
        let time_s: Vec<f64> = (0..50).map(|i| f64::from(i) * 0.1).collect();
        let spans = Spans::of(&time_s, &[0; 50], 0.4);
        let span = &spans.spans[0];
        let knot = |k: usize| 2.0 * span.knot_time_s(k, 0.4) - 1.0;
        for at in [-0.2, 0.0, 0.13, 2.0, 4.9, 5.1] {
            let place = spans.place(span, at);
            let sum = |w: &[f64; 4]| (0..4).map(|k| w[k] * knot(place.first + k)).sum::<f64>();
            assert!((sum(&place.position) - (2.0 * at - 1.0)).abs() < 1e-12, "{at}");
            assert!((sum(&place.velocity) - 2.0).abs() < 1e-12, "{at}");
            let (before, after) = (spans.place(span, at - 1e-6), spans.place(span, at + 1e-6));
            if before.first == after.first {
                for k in 0..4 {
                    let slope = (after.position[k] - before.position[k]) / 2e-6;
                    assert!((slope - place.velocity[k]).abs() < 1e-6, "{at} {k}");
                }
            }
        }
    }

    #[test]
    fn what_is_left_out_breaks_a_span() {
        let time_s = [0.0, 0.1, 0.2, 5.0, 5.1, 5.2, 5.3, 9.0];
        let spans = Spans::of(&time_s, &[0, 0, 0, 0, 0, 1, 1, 1], 0.02);
        let ends: Vec<_> = spans.spans.iter().map(|s| (s.start_s, s.end_s)).collect();
        assert_eq!(ends, [(0.0, 0.2), (5.0, 5.1), (5.2, 5.3)]);
        assert!(spans.at(3.0).is_none() && spans.at(5.25).is_some());
    }
}
