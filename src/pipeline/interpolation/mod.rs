//! Module 4: the positions of the three prisms at common instants.

mod linear;

use super::{FilteredTrack, Interpolation, Interval, Triplets};

/// Triplets on a grid of `rate_hz` from the start of each interval.
pub fn interpolate(
    tracks: &[FilteredTrack; 3],
    intervals: &[Interval],
    method: Interpolation,
    rate_hz: f64,
) -> Triplets {
    let (time_s, interval) = grid(intervals, rate_hz);
    let points_m = match method {
        Interpolation::Linear => tracks.each_ref().map(|track| linear::at(track, &time_s)),
    };
    Triplets::new(time_s, interval, points_m)
}

/// Instants (s) and the interval each belongs to.
fn grid(intervals: &[Interval], rate_hz: f64) -> (Vec<f64>, Vec<u32>) {
    let (mut time_s, mut owner) = (Vec::new(), Vec::new());
    for (index, interval) in intervals.iter().enumerate() {
        let steps = (interval.length_s() * rate_hz).floor() as usize;
        for step in 0..=steps {
            time_s.push(interval.start_s + step as f64 / rate_hz);
            owner.push(index as u32);
        }
    }
    (time_s, owner)
}
