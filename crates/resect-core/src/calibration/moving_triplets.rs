//! Triplets with velocities of their prisms, so that a clock offset can be corrected as a displacement.

use std::borrow::Cow;

use nalgebra::Vector3;

use crate::network::{Number, PerStation};
use crate::pipeline::Triplets;
use crate::statistics::median;

/// Delay of a station's stamps relative to station 1's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clock {
    /// Delay in the middle of the drive (s).
    pub offset_s: f64,
    /// Increase of the delay (s/s).
    pub drift: f64,
}

/// Triplets with the velocities of their prisms, each in its station's frame.
pub struct MovingTriplets<'a> {
    pub triplets: Cow<'a, Triplets>,
    /// Velocities (m/s) by differences with the neighbours in the same interval; differences do not span omitted triplets.
    pub velocity_m_per_s: PerStation<Vec<Vector3<f64>>>,
    /// Factor of a clock's second unknown for each triplet: time from the middle of the drive (s), or −0.5 and 0.5 before and after
    /// a jump.
    pub growth: Vec<f64>,
}

impl<'a> MovingTriplets<'a> {
    /// Returns all triplets, for clocks that drift.
    pub fn all(triplets: &'a Triplets) -> Self {
        let velocity_m_per_s = velocities(triplets, 1);
        let middle_s = middle_s(triplets);
        let growth = triplets.time_s.iter().map(|t| t - middle_s).collect();
        Self { triplets: Cow::Borrowed(triplets), velocity_m_per_s, growth }
    }

    /// Returns every `stride`-th triplet, with velocities from all triplets, for clocks that jump halfway.
    pub fn every(triplets: &Triplets, stride: usize) -> Self {
        let indices: Vec<usize> = (0..triplets.len()).step_by(stride).collect();
        let velocity_m_per_s = velocities(triplets, stride);
        let half = triplets.len() / 2;
        let growth = indices.iter().map(|i| if *i < half { -0.5 } else { 0.5 }).collect();
        Self { triplets: Cow::Owned(triplets.select(&indices)), velocity_m_per_s, growth }
    }

    /// Returns the prism position of a station at the time of its stamp, corrected for the delay of its clock (m, the
    /// station's frame).
    pub fn at_true_time(&self, station: usize, index: usize, clock: Clock) -> Vector3<f64> {
        let late_s = clock.offset_s + clock.drift * self.growth[index];
        self.triplets.points_m[station][index] + late_s * self.velocity_m_per_s[station][index]
    }
}

/// A time step longer than this many median steps spans omitted triplets.
const BRIDGE: f64 = 1.5;

fn velocities(triplets: &Triplets, stride: usize) -> PerStation<Vec<Vector3<f64>>> {
    let of =
        |points: &Vec<_>| velocity_m_per_s(&triplets.time_s, &triplets.interval, points, stride);
    triplets.points_m.map(of)
}

/// Returns the velocities at every `stride`-th of some points in one frame (m/s), from the points' times (s) and intervals.
pub fn velocity_m_per_s(
    time_s: &[f64],
    interval: &[u32],
    points_m: &[Vector3<f64>],
    stride: usize,
) -> Vec<Vector3<f64>> {
    let last = points_m.len().saturating_sub(1);
    let longest_s = BRIDGE * usual_step_s(time_s, interval).unwrap_or(f64::INFINITY);
    let at = |i: usize| {
        let same =
            |j: usize| interval[j] == interval[i] && (time_s[j] - time_s[i]).abs() <= longest_s;
        let before = if i > 0 && same(i - 1) { i - 1 } else { i };
        let after = if i < last && same(i + 1) { i + 1 } else { i };
        let span_s = time_s[after] - time_s[before];
        if span_s > 0.0 { (points_m[after] - points_m[before]) / span_s } else { Vector3::zeros() }
    };
    (0..points_m.len()).step_by(stride).map(at).collect()
}

/// Returns the median time step between triplets of one interval (s).
fn usual_step_s(time_s: &[f64], interval: &[u32]) -> Option<f64> {
    let pairs = time_s.windows(2).zip(interval.windows(2));
    median(pairs.filter(|(_, i)| i[0] == i[1]).map(|(t, _)| t[1] - t[0]))
}

/// Returns the time of the middle of a drive (s).
pub fn middle_s(triplets: &Triplets) -> f64 {
    match (triplets.time_s.first(), triplets.time_s.last()) {
        (Some(first), Some(last)) => 0.5 * (first + last),
        _ => 0.0,
    }
}

/// Returns the triplets with corrected clocks; that of station 1 is the reference.
pub fn with_clocks(triplets: &Triplets, clocks: &PerStation<Clock>) -> Triplets {
    let data = MovingTriplets::all(triplets);
    let mut points_m = triplets.points_m.clone();
    for (station, clock) in clocks.each().skip(1) {
        points_m[station] = (0..triplets.len())
            .map(|index| data.at_true_time(station.index(), index, *clock))
            .collect();
    }
    Triplets { points_m, ..triplets.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocities_do_not_bridge_what_was_left_out() {
        let point = |i: usize| Vector3::new((i as f64 * 0.1).powi(3), 0.0, 0.0);
        let points: Vec<_> = (0..60).map(point).collect();
        let time_s = (0..60).map(|i| i as f64 * 0.1).collect();
        let all = Triplets::new(time_s, vec![0; 60], [points.clone(), points.clone(), points]);
        let kept: Vec<usize> = (0..60).filter(|i| !(20..45).contains(i)).collect();
        let some = all.select(&kept);
        let data = MovingTriplets::all(&some);
        for (place, index) in kept.iter().enumerate().filter(|(_, i)| (15..50).contains(*i)) {
            let velocity = data.velocity_m_per_s[1][place].x;
            let truth = 3.0 * (*index as f64 * 0.1).powi(2);
            assert!((velocity / truth - 1.0).abs() < 0.08, "{index}: {velocity} for {truth}");
        }
    }
}
