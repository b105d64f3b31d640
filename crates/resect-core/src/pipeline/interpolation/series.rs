//! The readings of one station in one interval, and estimates made interval by interval.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::pipeline::interval_split::Interval;
use crate::pipeline::outlier_filter::FilteredTrack;
use crate::progress::Cancelled;

/// Positions with what the model says of their own error.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Estimate {
    pub points_m: Vec<Vector3<f64>>,
    /// One standard deviation of the prism's position along each axis (m); the noise of readings is not added.
    pub sigma_m: Vec<Vector3<f64>>,
}

/// The axes that share hyper-parameters: level ones together, so that a turn about z turns the answer alike.
pub const AXIS_GROUPS: [&[usize]; 2] = [&[0, 1], &[2]];

/// An interval with fewer readings takes the hyper-parameters of its whole station.
pub const FEWEST_TO_LEARN_FROM: usize = 20;

/// Error (m) that each reading is taken to have beyond what was learned: far below any instrument's, it keeps the
/// likelihood finite where readings fit the model without error.
pub const LEAST_NOISE_M: f64 = 1e-5;

/// One station's readings for one interval.
pub struct Series {
    /// Times since the interval's start (s): the stamps are Unix times, too large for arithmetic on their squares.
    pub time_s: Vec<f64>,
    pub position_m: Vec<Vector3<f64>>,
}

impl Series {
    /// Takes the readings from the last at or before the interval's start to the first at or after its end.
    pub fn new(track: &FilteredTrack, interval: &Interval) -> Self {
        let from = track.time_s.partition_point(|t| *t <= interval.start_s).saturating_sub(1);
        let to = track.time_s.partition_point(|t| *t < interval.end_s) + 1;
        let range = from..to.min(track.time_s.len());
        Self {
            time_s: track.time_s[range.clone()].iter().map(|t| t - interval.start_s).collect(),
            position_m: track.position_m[range].to_vec(),
        }
    }

    pub fn len(&self) -> usize {
        self.time_s.len()
    }
}

/// Asks `predict` for each interval's instants, given by the interval's number, its readings, and in seconds from its
/// start; intervals side by side.
pub fn by_interval(
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
