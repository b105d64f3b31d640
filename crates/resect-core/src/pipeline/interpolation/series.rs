//! Readings of one station in one interval, and interpolation interval by interval.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::pipeline::interval_split::Interval;
use crate::pipeline::outlier_filter::FilteredTrack;
use crate::progress::Cancelled;

/// Interpolated positions and their standard deviations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InterpolatedTrack {
    pub points_m: Vec<Vector3<f64>>,
    /// Standard deviation of the prism's position along each axis (m), without the noise of readings.
    pub sigma_m: Vec<Vector3<f64>>,
}

/// Axes that share hyper-parameters. The horizontal ones share theirs, so that a rotation about z rotates the result alike.
pub const AXIS_GROUPS: [&[usize]; 2] = [&[0, 1], &[2]];

/// Smallest number of readings to learn from; a shorter interval uses the hyper-parameters of its whole station.
pub const FEWEST_TO_LEARN_FROM: usize = 20;

/// Noise (m) that is added to the learned one. It is far below any instrument's, and keeps the likelihood finite if the
/// readings fit the model exactly.
pub const LEAST_NOISE_M: f64 = 1e-5;

/// Readings of one station in one interval.
pub struct ReadingSeries {
    /// Times since the interval's start (s); Unix times are too large for arithmetic with their squares.
    pub time_s: Vec<f64>,
    pub position_m: Vec<Vector3<f64>>,
}

impl ReadingSeries {
    /// Selects the readings from the last at or before the interval's start to the first at or after its end.
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

/// Calls `predict` for each interval, in parallel. Its arguments are the interval's index, its readings, and its instants
/// (s after its start).
pub fn by_interval(
    track: &FilteredTrack,
    intervals: &[Interval],
    (time_s, interval): (&[f64], &[u32]),
    predict: impl Fn(usize, &ReadingSeries, &[f64]) -> Result<InterpolatedTrack, Cancelled> + Sync,
) -> Result<InterpolatedTrack, Cancelled> {
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
        predict(index, &ReadingSeries::new(track, &intervals[index]), &instants)
    };
    let found: Vec<InterpolatedTrack> =
        pieces.par_iter().map(of_piece).collect::<Result<_, _>>()?;
    Ok(InterpolatedTrack {
        points_m: found.iter().flat_map(|piece| &piece.points_m).copied().collect(),
        sigma_m: found.iter().flat_map(|piece| &piece.sigma_m).copied().collect(),
    })
}
