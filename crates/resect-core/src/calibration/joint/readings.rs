//! Readings of the stations, each at its own time.

use std::ops::{Deref, Range};
use std::sync::Arc;

use nalgebra::Vector3;

use super::sight::Sight;
use crate::network::PerStation;
use crate::pipeline::Triplets;
use crate::statistics::median;

/// Readings or triplets further apart than this many usual steps have a gap between them.
pub const STEPS_APART: f64 = 2.5;

/// One reading of one station, in its own frame. Its [`Sight`] is computed when it is needed: long drives have millions of readings.
#[derive(Clone, Debug)]
pub struct Reading {
    pub time_s: f64,
    pub point_m: Vector3<f64>,
}

impl Reading {
    pub fn sight(&self) -> Sight {
        Sight::to(&self.point_m)
    }
}

/// The readings of a drive that the estimate takes, each at its own time.
#[derive(Clone, Debug)]
pub struct DriveReadings {
    /// By station, in order of time.
    pub tracks: PerStation<Arc<Vec<Reading>>>,
    /// Start of each further drive (s).
    pub restarts_s: Vec<f64>,
}

impl DriveReadings {
    /// Returns the readings that the joint estimate takes: all, or those that triplets are interpolated from, if they have no others.
    pub fn taken(triplets: &Triplets) -> Self {
        match triplets.of_all_readings.as_deref() {
            Some(all) => Self::all(all),
            None => Self::of_triplets(triplets),
        }
    }

    /// Returns all readings of the tracks behind triplets.
    pub fn all(triplets: &Triplets) -> Self {
        Self::some(triplets, |_| true)
    }

    fn some(triplets: &Triplets, is_kept: impl Fn(f64) -> bool) -> Self {
        let tracks = triplets.readings.map(|track| {
            let both = track.time_s.iter().zip(&track.position_m);
            let kept = both.filter(|(time_s, _)| is_kept(**time_s));
            let reading = |(time_s, point_m): (&f64, &Vector3<f64>)| Reading {
                time_s: *time_s,
                point_m: *point_m,
            };
            Arc::new(kept.map(reading).collect())
        });
        Self { tracks, restarts_s: triplets.restarts_s.clone() }
    }

    /// Returns those readings that triplets are interpolated from, without gaps in their time.
    pub fn of_triplets(triplets: &Triplets) -> Self {
        let all = triplets.with_other_prisms();
        let triplets = all.as_ref().unwrap_or(triplets);
        let step_s = median_step_s(triplets.time_s.iter().copied());
        let instants: Vec<(f64, u32)> =
            triplets.time_s.iter().copied().zip(triplets.interval.iter().copied()).collect();
        let unbroken = instants.chunk_by(|(before_s, before), (after_s, after)| {
            before == after && after_s - before_s <= STEPS_APART * step_s
        });
        let spans_s: Vec<[f64; 2]> =
            unbroken.map(|span| [span[0].0, span[span.len() - 1].0]).collect();
        Self::some(triplets, |time_s| {
            let index = spans_s.partition_point(|[_, end_s]| *end_s < time_s);
            spans_s.get(index).is_some_and(|[start_s, _]| *start_s <= time_s)
        })
    }

    /// Start and end of each drive (s).
    pub fn spans_s(&self) -> Vec<[f64; 2]> {
        let first_s = self.tracks.iter().filter_map(|track| track.first());
        let first_s = first_s.map(|reading| reading.time_s).fold(f64::INFINITY, f64::min);
        let starts_s: Vec<f64> =
            std::iter::once(first_s).chain(self.restarts_s.iter().copied()).collect();
        let span_s = |(index, start_s): (usize, &f64)| {
            let next_s = starts_s.get(index + 1).copied().unwrap_or(f64::INFINITY);
            let of_track = |track: &Arc<Vec<Reading>>| {
                let from = track.partition_point(|reading| reading.time_s < *start_s);
                let to = track.partition_point(|reading| reading.time_s < next_s);
                let of_drive = &track[from..to];
                Some([of_drive.first()?.time_s, of_drive.last()?.time_s])
            };
            let spans_s = self.tracks.iter().filter_map(of_track);
            spans_s.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])
        };
        starts_s.iter().enumerate().filter_map(span_s).collect()
    }
}

/// Consecutive readings of a track. They are not copied: long drives have millions.
#[derive(Clone, Debug)]
pub struct ReadingSpan {
    track: Arc<Vec<Reading>>,
    range: Range<usize>,
}

impl ReadingSpan {
    /// The readings of a track from one instant to another (s).
    pub fn between(track: &Arc<Vec<Reading>>, start_s: f64, end_s: f64) -> Self {
        let from = track.partition_point(|reading| reading.time_s < start_s);
        let to = track.partition_point(|reading| reading.time_s <= end_s);
        Self { track: Arc::clone(track), range: from..to.max(from) }
    }
}

impl From<Vec<Reading>> for ReadingSpan {
    fn from(readings: Vec<Reading>) -> Self {
        Self { range: 0..readings.len(), track: Arc::new(readings) }
    }
}

impl Deref for ReadingSpan {
    type Target = [Reading];

    fn deref(&self) -> &[Reading] {
        &self.track[self.range.clone()]
    }
}

/// Median time between consecutive instants (s).
pub fn median_step_s(time_s: impl Iterator<Item = f64> + Clone) -> f64 {
    let steps_s = time_s.clone().zip(time_s.skip(1)).map(|(before, after)| after - before);
    median(steps_s).unwrap_or(f64::NAN)
}
