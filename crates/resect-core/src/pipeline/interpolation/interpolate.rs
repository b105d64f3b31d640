//! Interpolation of the tracks with one of the models.

use rayon::prelude::*;

use super::series::InterpolatedTrack;
use super::{linear, squared_exponential, white_noise_on_acceleration};
use crate::network::PerStation;
use crate::pipeline::interval_split::Interval;
use crate::pipeline::outlier_filter::FilteredTrack;
use crate::pipeline::settings::Interpolation;
use crate::pipeline::triplets::Triplets;
use crate::progress::{Cancelled, Progress};

/// Interpolates triplets at `rate_hz` from the start of each interval, unless `progress` is cancelled.
pub fn interpolate(
    tracks: &PerStation<FilteredTrack>,
    intervals: &[Interval],
    method: Interpolation,
    rate_hz: f64,
    progress: &Progress,
) -> Result<Triplets, Cancelled> {
    let (time_s, interval) = grid(intervals, rate_hz);
    let model = match method {
        Interpolation::Linear => {
            let points_m = tracks.map(|track| linear::at(track, &time_s));
            return Ok(Triplets::new(time_s, interval, points_m));
        }
        Interpolation::Gp => squared_exponential::at,
        Interpolation::Wnoa => white_noise_on_acceleration::at,
    };
    let of_track = |track| model(track, intervals, (&time_s, &interval), progress);
    let estimates: Vec<InterpolatedTrack> =
        tracks.as_slice().par_iter().map(of_track).collect::<Result<_, _>>()?;
    let (mut points_m, mut sigma_m) = (PerStation::default(), PerStation::default());
    for estimate in estimates {
        points_m.push(estimate.points_m);
        sigma_m.push(estimate.sigma_m);
    }
    Ok(Triplets { sigma_m: Some(sigma_m), ..Triplets::new(time_s, interval, points_m) })
}

/// Returns instants (s) at a rate from the start of each interval, and the index of the interval of each.
pub fn grid(intervals: &[Interval], rate_hz: f64) -> (Vec<f64>, Vec<u32>) {
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
