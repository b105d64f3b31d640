//! The data of a joint estimate: the triplets that it starts from, and the readings that it takes.

use nalgebra::Vector3;

use super::followed_prisms::schedule;
use super::inter_prism::gross_errors;
use super::joint::{DriveReadings, Reading};
use crate::deployment::{Deployment, Rig};
use crate::geometry::LevelTransform;
use crate::network::{Pair, PerStation, Prism, PrismSchedule, Station};
use crate::pipeline::Triplets;
use crate::statistics::median;

/// Readings of another station further apart than this many median steps are not interpolated.
const STEPS_APART: f64 = 2.5;

/// Most readings of a station from which the usual error is taken.
const MOST_MEASURED: usize = 2000;

/// The data of a joint estimate.
#[derive(Clone, Debug)]
pub struct JointData<'a> {
    pub triplets: &'a Triplets,
    pub readings: DriveReadings,
}

impl<'a> JointData<'a> {
    /// Takes all readings, or those that the triplets are interpolated from, if they have no others.
    pub fn new(triplets: &'a Triplets) -> Self {
        match triplets.of_all_readings.as_deref() {
            Some(all) => Self { triplets: all, readings: DriveReadings::all(all) },
            None => Self { triplets, readings: DriveReadings::of_triplets(triplets) },
        }
    }

    /// Returns the readings whose distances to those of other stations fit an answer, and those of a station alone.
    ///
    /// Of two that contradict each other, the one that fits more other stations is kept; neither, if they fit as many.
    pub fn fitting(
        &self,
        deployment: &Deployment,
        followed: &PerStation<Prism>,
        station1_from_station: &PerStation<LevelTransform>,
    ) -> DriveReadings {
        let placed: PerStation<PlacedTrack> = self
            .readings
            .tracks
            .zip(station1_from_station, |track, transform| PlacedTrack::new(track, transform));
        let (schedule, rig) = (schedule(deployment, followed), deployment.rig.as_ref());
        let errors = |station: Station, reading: &Reading| {
            InstantErrors::new(&placed, (&schedule, rig), station, reading.time_s)
        };
        let worst_m = self.readings.tracks.each().flat_map(|(station, track)| {
            let some = track.iter().step_by(track.len().div_ceil(MOST_MEASURED).max(1));
            some.filter_map(move |reading| errors(station, reading).worst_m(station))
        });
        let Some(limit_m) = gross_errors::limit_m(worst_m) else { return self.readings.clone() };
        let tracks = self.readings.tracks.map_each(|station, track| {
            let fits = |reading: &&Reading| errors(station, reading).is_kept(station, limit_m);
            track.iter().filter(fits).cloned().collect()
        });
        DriveReadings { tracks, restarts_s: self.readings.restarts_s.clone() }
    }
}

/// A track in the frame of station 1.
struct PlacedTrack {
    time_s: Vec<f64>,
    position_m: Vec<Vector3<f64>>,
    longest_s: f64,
}

impl PlacedTrack {
    fn new(track: &[Reading], transform: &LevelTransform) -> Self {
        let time_s: Vec<f64> = track.iter().map(|reading| reading.time_s).collect();
        let position_m = track.iter().map(|reading| transform.apply(&reading.point_m)).collect();
        let step_s = median(time_s.windows(2).map(|both| both[1] - both[0])).unwrap_or(0.0);
        Self { time_s, position_m, longest_s: STEPS_APART * step_s }
    }

    /// Returns the position at an instant (m); `None` in a gap.
    fn at(&self, time_s: f64) -> Option<Vector3<f64>> {
        let after = self.time_s.partition_point(|t| *t < time_s);
        if self.time_s.get(after) == Some(&time_s) {
            return Some(self.position_m[after]);
        }
        let (before, to_s) = (after.checked_sub(1)?, *self.time_s.get(after)?);
        let from_s = self.time_s[before];
        let share = (time_s - from_s) / (to_s - from_s);
        let is_near = to_s - from_s <= self.longest_s;
        is_near.then(|| self.position_m[before].lerp(&self.position_m[after], share))
    }
}

/// Errors of the distances between the stations that have a position at an instant.
struct InstantErrors {
    /// Two stations, and the error of their distance (m).
    pairs: Vec<([Station; 2], f64)>,
}

impl InstantErrors {
    fn new(
        placed: &PerStation<PlacedTrack>,
        (schedule, rig): (&PrismSchedule, Option<&Rig>),
        own: Station,
        time_s: f64,
    ) -> Self {
        let followed = schedule.at(time_s);
        let position = |(station, track): (Station, &PlacedTrack)| {
            Some((station, followed[station], track.at(time_s)?))
        };
        let present: Vec<(Station, Prism, Vector3<f64>)> =
            placed.each().filter_map(position).collect();
        let mut pairs = Vec::new();
        // Without the own position, all of its pairs are unknown.
        if present.iter().all(|(station, ..)| *station != own) {
            return Self { pairs };
        }
        for (index, (a, prism_a, a_m)) in present.iter().enumerate() {
            for (b, prism_b, b_m) in &present[index + 1..] {
                let known_m = match Pair::between(*prism_a, *prism_b) {
                    None => Some(0.0),
                    Some(pair) => rig.and_then(|rig| rig.inter_prism_m.get(pair)).copied(),
                };
                let Some(known_m) = known_m else { continue };
                pairs.push(([*a, *b], ((a_m - b_m).norm() - known_m).abs()));
            }
        }
        Self { pairs }
    }

    /// Returns the largest error of a station's distances (m); `None` for a station alone.
    fn worst_m(&self, station: Station) -> Option<f64> {
        let own = self.pairs.iter().filter(|(stations, _)| stations.contains(&station));
        own.map(|(_, error_m)| *error_m).reduce(f64::max)
    }

    /// Number of a station's distances that fit.
    fn fitting(&self, station: Station, limit_m: f64) -> usize {
        let own = self.pairs.iter().filter(|(stations, _)| stations.contains(&station));
        own.filter(|(_, error_m)| *error_m < limit_m).count()
    }

    fn is_kept(&self, station: Station, limit_m: f64) -> bool {
        let own = self.fitting(station, limit_m);
        let contradicts = |(stations, error_m): &([Station; 2], f64)| {
            stations.contains(&station)
                && *error_m >= limit_m
                && stations
                    .iter()
                    .any(|other| *other != station && self.fitting(*other, limit_m) >= own)
        };
        !self.pairs.iter().any(contradicts)
    }
}
