//! The motion of the prisms as uniform cubic B-splines, one for each unbroken stretch of a drive, and the parts of these.

use std::ops::Range;

use super::band_rows::TIED;
use crate::statistics::median;

/// Clocks may be off by this much (s); the splines reach as far beyond their stretches.
const MARGIN_S: f64 = 0.25;
/// Shorter stretches than this many knots hold too few readings for a motion.
const FEWEST_KNOTS: f64 = 4.0;
/// Longer ones are cut: what a cut forgets of the motion is nothing beside so many knots, whose rows stay near the
/// processor, and stretches are eliminated side by side. Where the motion itself is asked for, [`super::cuts`] makes up for it.
const MOST_KNOTS: f64 = 100.0;
/// Instants further apart than this many of their own steps belong to different stretches.
const STEPS_APART: f64 = 2.5;
/// What is slow is constant for this many knots at least.
const PART_KNOTS: f64 = 16.0;

/// One unbroken stretch of the drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    pub start_s: f64,
    pub end_s: f64,
    /// Time between knots (s).
    pub knot_s: f64,
    pub knots: usize,
    /// Equal parts that it is cut into.
    pub parts: usize,
}

/// Four knots from `first` on, with what each adds to the position and to the velocity (1/s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    pub first: usize,
    pub position: [f64; TIED],
    pub velocity: [f64; TIED],
}

/// The stretches of consecutive instants of the same interval, in parts of about `part_s`; what is too short is left out.
pub fn stretches(time_s: &[f64], interval: &[u32], knot_s: f64, part_s: f64) -> Vec<Stretch> {
    let apart_s = STEPS_APART * median(time_s.windows(2).map(|w| w[1] - w[0])).unwrap_or(1.0);
    unbroken(time_s, interval, apart_s)
        .into_iter()
        .map(|range| (time_s[range.start], time_s[range.end - 1]))
        .filter(|(start_s, end_s)| end_s - start_s >= FEWEST_KNOTS * knot_s)
        .flat_map(|(start_s, end_s)| {
            let pieces = ((end_s - start_s) / (MOST_KNOTS * knot_s)).ceil().max(1.0);
            let cut_s = move |k: f64| start_s + (end_s - start_s) * k / pieces;
            // No instant is in two of them.
            (0..pieces as usize).map(move |k| match k as f64 {
                0.0 => (start_s, if pieces > 1.0 { cut_s(1.0) } else { end_s }),
                k if k + 1.0 < pieces => (cut_s(k).next_up(), cut_s(k + 1.0)),
                k => (cut_s(k).next_up(), end_s),
            })
        })
        .map(|(start_s, end_s)| {
            let part_s = part_s.max(PART_KNOTS * knot_s);
            let parts = ((end_s - start_s) / part_s).floor().max(1.0) as usize;
            Stretch::new([start_s, end_s], knot_s, parts)
        })
        .collect()
}

impl Stretch {
    fn new([start_s, end_s]: [f64; 2], knot_s: f64, parts: usize) -> Self {
        let knots = ((end_s - start_s + 2.0 * MARGIN_S) / knot_s).ceil() as usize + 3;
        Self { start_s, end_s, knot_s, knots, parts }
    }

    /// A stretch about the cut between this one and the next, of a part on either side; `None` where they do not meet.
    pub fn about_cut(&self, next: &Self) -> Option<Self> {
        // No part is shorter, and each half of it lies within one.
        let half_s = PART_KNOTS * self.knot_s;
        let (from_s, to_s) = (self.end_s - half_s, self.end_s + half_s);
        (next.start_s == self.end_s.next_up()).then(|| Self::new([from_s, to_s], self.knot_s, 2))
    }

    /// What the knots add at an instant, at most the margin outside of the stretch.
    pub fn place(&self, time_s: f64) -> Place {
        let along = (time_s - self.start_s + MARGIN_S) / self.knot_s;
        let along = along.clamp(0.0, (self.knots - 3) as f64 - 1e-9);
        let (first, u) = (along as usize, along.fract());
        let v = 1.0 - u;
        let cubic = |u: f64| (3.0 * u - 6.0) * u * u + 4.0;
        let quadratic = |u: f64| (9.0 * u - 12.0) * u;
        let rate = 1.0 / (6.0 * self.knot_s);
        Place {
            first,
            position: [v * v * v, cubic(u), cubic(v), u * u * u].map(|w| w / 6.0),
            velocity: [-3.0 * v * v, quadratic(u), -quadratic(v), 3.0 * u * u].map(|w| w * rate),
        }
    }

    /// When a knot's own spline is at its highest (s).
    pub fn knot_time_s(&self, knot: usize) -> f64 {
        self.start_s - MARGIN_S + (knot as f64 - 1.0) * self.knot_s
    }

    /// The middle of what is between the second and the third of four knots (s).
    pub fn segment_time_s(&self, first: usize) -> f64 {
        self.knot_time_s(first) + 1.5 * self.knot_s
    }

    /// Whether an instant is in it.
    pub fn has(&self, time_s: f64) -> bool {
        (self.start_s..=self.end_s).contains(&time_s)
    }

    fn part_s(&self) -> f64 {
        (self.end_s - self.start_s) / self.parts as f64
    }

    /// The part that an instant is in.
    pub fn part(&self, time_s: f64) -> usize {
        (((time_s - self.start_s) / self.part_s()).max(0.0) as usize).min(self.parts - 1)
    }

    /// The middle of a part (s).
    pub fn part_time_s(&self, part: usize) -> f64 {
        self.start_s + (part as f64 + 0.5) * self.part_s()
    }

    /// The first knot that each part's readings act on, as far as their clocks may be off.
    pub fn first_knots(&self) -> Vec<usize> {
        let begins_s = |part: usize| self.start_s + part as f64 * self.part_s() - MARGIN_S;
        (0..self.parts)
            .map(|part| if part == 0 { 0 } else { self.place(begins_s(part)).first })
            .collect()
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
        let stretch = &stretches(&time_s, &[0; 50], 0.4, 6.0)[0];
        let knot = |k: usize| 2.0 * stretch.knot_time_s(k) - 1.0;
        for at in [-0.2, 0.0, 0.13, 2.0, 4.9, 5.1] {
            let place = stretch.place(at);
            let sum = |w: &[f64; 4]| (0..4).map(|k| w[k] * knot(place.first + k)).sum::<f64>();
            assert!((sum(&place.position) - (2.0 * at - 1.0)).abs() < 1e-12, "{at}");
            assert!((sum(&place.velocity) - 2.0).abs() < 1e-12, "{at}");
            let (before, after) = (stretch.place(at - 1e-6), stretch.place(at + 1e-6));
            if before.first == after.first {
                for k in 0..4 {
                    let slope = (after.position[k] - before.position[k]) / 2e-6;
                    assert!((slope - place.velocity[k]).abs() < 1e-6, "{at} {k}");
                }
            }
        }
    }

    #[test]
    fn what_is_left_out_breaks_a_stretch() {
        let time_s = [0.0, 0.1, 0.2, 5.0, 5.1, 5.2, 5.3, 9.0];
        let stretches = stretches(&time_s, &[0, 0, 0, 0, 0, 1, 1, 1], 0.02, 6.0);
        let ends: Vec<_> = stretches.iter().map(|s| (s.start_s, s.end_s)).collect();
        assert_eq!(ends, [(0.0, 0.2), (5.0, 5.1), (5.2, 5.3)]);
    }
}
