//! Module 4: the positions of the three prisms at common instants.
//!
//! [`linear`] as published; [`squared_exponential`] and [`white_noise_on_acceleration`] learn their hyper-parameters,
//! noise included, and say how well each position is known.

mod dense;
mod elimination;
mod kernel;
mod linear;
mod minimise;
pub mod squared_exponential;
#[cfg(test)]
mod tests;
pub mod white_noise_on_acceleration;

use std::cell::Cell;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::{FilteredTrack, Interpolation, Interval, Triplets};
use crate::progress::{Cancelled, Progress};

/// Triplets on a grid of `rate_hz` from the start of each interval, unless `progress` is cancelled.
pub fn interpolate(
    tracks: &[FilteredTrack; 3],
    intervals: &[Interval],
    method: Interpolation,
    rate_hz: f64,
    progress: &Progress,
) -> Result<Triplets, Cancelled> {
    let (time_s, interval) = grid(intervals, rate_hz);
    let model = match method {
        Interpolation::Linear => {
            let points_m = tracks.each_ref().map(|track| linear::at(track, &time_s));
            return Ok(Triplets::new(time_s, interval, points_m));
        }
        Interpolation::Gp => squared_exponential::at,
        Interpolation::Wnoa => white_noise_on_acceleration::at,
    };
    let of_track = |track| model(track, intervals, (&time_s, &interval), progress);
    let mut estimates: Vec<Estimate> = tracks.par_iter().map(of_track).collect::<Result<_, _>>()?;
    let mut sigma_m = [const { Vec::new() }; 3];
    let mut points_m = [const { Vec::new() }; 3];
    for (station, estimate) in estimates.drain(..).enumerate() {
        points_m[station] = estimate.points_m;
        sigma_m[station] = estimate.sigma_m;
    }
    Ok(Triplets { sigma_m: Some(sigma_m), ..Triplets::new(time_s, interval, points_m) })
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

/// Positions with what the model says of their own error.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Estimate {
    pub points_m: Vec<Vector3<f64>>,
    /// One standard deviation of the prism's position along each axis (m); the noise of readings is not added.
    pub sigma_m: Vec<Vector3<f64>>,
}

/// The axes that share hyper-parameters: level ones together, so that a turn about z turns the answer alike.
const AXIS_GROUPS: [&[usize]; 2] = [&[0, 1], &[2]];

/// An interval with fewer readings takes the hyper-parameters of its whole station.
const FEWEST_TO_LEARN_FROM: usize = 20;

/// Error (m) that each reading is taken to have beyond what was learned: far below any instrument's, it keeps the
/// likelihood finite where readings fit the model without error.
const LEAST_NOISE_M: f64 = 1e-5;

/// What a search is taken to cost, in readings looked at: how often it will look, nobody knows beforehand.
struct Allowance<'a> {
    progress: &'a Progress,
    left: Cell<u64>,
}

impl<'a> Allowance<'a> {
    /// Tells `progress` of a search through so many readings.
    fn new(progress: &'a Progress, readings: usize) -> Self {
        const USUAL_LOOKS: u64 = 30;
        let left = USUAL_LOOKS * readings as u64;
        progress.expect(left);
        Self { progress, left: Cell::new(left) }
    }

    /// Counts readings that were looked at once more, and says whether the search shall go on.
    fn spend(&self, readings: usize) -> bool {
        if self.progress.is_cancelled() {
            return false;
        }
        let amount = self.left.get().min(readings as u64);
        self.left.set(self.left.get() - amount);
        self.progress.advance(amount).is_ok()
    }

    /// The search is over, sooner than thought or not.
    fn end(self) -> Result<(), Cancelled> {
        self.progress.check()?;
        self.progress.advance(self.left.get())
    }
}

/// One station's readings for one interval.
struct Series {
    /// Times since the interval's start (s): the stamps are Unix times, too large for arithmetic on their squares.
    time_s: Vec<f64>,
    position_m: Vec<Vector3<f64>>,
}

impl Series {
    /// Takes the readings from the last at or before the interval's start to the first at or after its end.
    fn new(track: &FilteredTrack, interval: &Interval) -> Self {
        let from = track.time_s.partition_point(|t| *t <= interval.start_s).saturating_sub(1);
        let to = track.time_s.partition_point(|t| *t < interval.end_s) + 1;
        let range = from..to.min(track.time_s.len());
        Self {
            time_s: track.time_s[range.clone()].iter().map(|t| t - interval.start_s).collect(),
            position_m: track.position_m[range].to_vec(),
        }
    }

    fn len(&self) -> usize {
        self.time_s.len()
    }
}

/// Asks `predict` for each interval's instants, given by the interval's number, its readings, and in seconds from its
/// start; intervals side by side.
fn by_interval(
    track: &FilteredTrack,
    intervals: &[Interval],
    (time_s, interval): (&[f64], &[u32]),
    predict: impl Fn(usize, &Series, &[f64]) -> Result<Estimate, Cancelled> + Sync,
) -> Result<Estimate, Cancelled> {
    let mut asked = time_s;
    let pieces: Vec<_> = interval
        .chunk_by(|a, b| a == b)
        .map(|same| {
            let (own, others) = asked.split_at(same.len());
            asked = others;
            (same[0] as usize, own)
        })
        .collect();
    let of_piece = |&(index, times_s): &(usize, &[f64])| {
        let start_s = intervals[index].start_s;
        let instants: Vec<f64> = times_s.iter().map(|t| t - start_s).collect();
        predict(index, &Series::new(track, &intervals[index]), &instants)
    };
    let found: Vec<Estimate> = pieces.par_iter().map(of_piece).collect::<Result<_, _>>()?;
    Ok(Estimate {
        points_m: found.iter().flat_map(|piece| &piece.points_m).copied().collect(),
        sigma_m: found.iter().flat_map(|piece| &piece.sigma_m).copied().collect(),
    })
}
