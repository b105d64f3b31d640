//! The data of a joint estimate: the triplets that it starts from, and the readings that it takes.

use std::sync::Arc;

use nalgebra::Vector3;

use super::followed_prisms::schedule;
use super::gross_error_limit::gross_error_limit_of_step_m;
use super::joint::{DriveReadings, Reading, STEPS_APART};
use crate::deployment::findings::outliers::station_left_out;
use crate::deployment::{Deployment, Finding, Rig};
use crate::geometry::LevelTransform;
use crate::network::{Number, Pair, PerStation, Prism, Station};
use crate::pipeline::Triplets;
use crate::statistics::median;

/// Most readings of a station from which the usual error is taken.
const MOST_MEASURED: usize = 2000;

/// Fewest readings of a run that is reported. Single outliers are common.
const FEWEST_IN_RUN: usize = 4;
/// Shortest time of a run that is reported (s).
const SHORTEST_RUN_S: f64 = 1.5;

/// Consecutive readings of a station that contradict those of other stations.
#[derive(Clone, Debug, PartialEq)]
pub struct ContradictingRun {
    pub station: Station,
    /// Times of the first and the last reading (s).
    pub span_s: [f64; 2],
    pub readings: usize,
    /// Median of their worst distance errors (m).
    pub error_m: f64,
    /// The prism that the station followed instead of its own, if one explains the readings.
    pub prism: Option<Prism>,
}

/// Returns a finding for each station with runs, about its longest one; the drive begins at `start_s`.
pub fn contradicting_runs(runs: &[ContradictingRun], start_s: f64) -> Vec<Finding> {
    let of_station = |runs: &[ContradictingRun]| {
        let length_s = |run: &ContradictingRun| run.span_s[1] - run.span_s[0];
        let longest = runs.iter().max_by(|a, b| length_s(a).total_cmp(&length_s(b)))?;
        let ContradictingRun { station, span_s, readings, error_m, prism } = longest;
        Some(station_left_out(
            (station.index(), prism.map(Prism::number)),
            (*span_s, start_s),
            (*readings, *error_m),
            runs.len() - 1,
        ))
    };
    runs.chunk_by(|a, b| a.station == b.station).filter_map(of_station).collect()
}

/// Shortest time of a run of contested readings that is decided as a whole (s).
const SHORTEST_DECIDED_S: f64 = 0.5;
/// Least share of such a run that is kept; otherwise all of it is left out.
/// Simulated: three readings that were kept of a prism on which a station was wrong for two seconds moved heights by 30 mm, 6 σ.
const LEAST_KEPT: f64 = 0.75;
/// Another prism fits a reading if its error is less than this share of the own one.
/// Simulated: heights were 30 mm off, 6 σ, where a station was on another prism of a nearly equilateral rig that one other station saw.
const CLEARLY_LESS: f64 = 0.5;
/// It is also less by this share of the limit of gross errors.
/// Simulated: without this limit noise decides where distances are the same, and one of 400 drives does not converge.
const CLEAR_SHARE: f64 = 0.2;

/// The data of a joint estimate.
#[derive(Clone, Copy, Debug)]
pub struct JointData<'a> {
    /// The triplets that it starts from.
    pub triplets: &'a Triplets,
    /// The triplets of the published method, which answers if the joint estimate fails.
    pub of_published: &'a Triplets,
}

impl<'a> JointData<'a> {
    /// Takes all readings, or those that the triplets are interpolated from, if they have no others.
    pub fn new(triplets: &'a Triplets) -> Self {
        let all = triplets.of_all_readings.as_deref().unwrap_or(triplets);
        Self { triplets: all, of_published: triplets }
    }

    /// Returns the readings whose distances to those of other stations fit an answer, those of a station alone, and the runs of the others.
    ///
    /// If two contradict each other, the one that fits more other stations is kept; neither, if they fit as many.
    pub fn fitting(
        &self,
        deployment: &Deployment,
        followed: &PerStation<Prism>,
        station1_from_station: &PerStation<LevelTransform>,
    ) -> (DriveReadings, Vec<ContradictingRun>) {
        let readings = DriveReadings::taken(self.of_published);
        let both = readings.tracks.iter().zip(station1_from_station);
        let placed: PerStation<PlacedTrack<'_>> =
            both.map(|(track, transform)| PlacedTrack::new(track, transform)).collect();
        let (schedule, rig) = (schedule(deployment, followed), deployment.rig.as_ref());
        let errors = |station: Station, reading: &Reading| {
            let followed = schedule.at(reading.time_s);
            InstantErrors::new(&placed, (followed, rig), station, reading.time_s)
        };
        let worst_m = readings.tracks.each().flat_map(|(station, track)| {
            let some = track.iter().step_by(track.len().div_ceil(MOST_MEASURED).max(1));
            some.filter_map(move |reading| errors(station, reading).worst_m(station))
        });
        let step_s = placed.iter().map(|track| track.longest_s / STEPS_APART).fold(0.0, f64::max);
        let Some(limit_m) = gross_error_limit_of_step_m(worst_m, step_s) else {
            return (readings, Vec::new());
        };
        // The error of a run's readings if the station followed another prism (m).
        let error_m = |station: Station, run: &[&Reading], other: Option<Prism>| {
            let worst_m = run.iter().filter_map(|reading| {
                let mut followed = schedule.at(reading.time_s).clone();
                followed[station] = other.unwrap_or(followed[station]);
                let errors = InstantErrors::new(&placed, (&followed, rig), station, reading.time_s);
                errors.worst_m(station)
            });
            median(worst_m)
        };
        let prisms = rig.and_then(|rig| Pair::prisms_of(rig.inter_prism_m.len())).unwrap_or(0);
        let mut runs = Vec::new();
        let tracks = readings.tracks.map_each(|station, track| {
            let judged =
                track.iter().map(|reading| errors(station, reading).judged(station, limit_m));
            let is_kept =
                kept_by_runs(track, &judged.collect::<Vec<_>>(), placed[station].longest_s);
            let both: Vec<(&Reading, bool)> = track.iter().zip(is_kept).collect();
            for run in both.chunk_by(|(_, a), (_, b)| a == b).filter(|run| !run[0].1) {
                let run: Vec<&Reading> = run.iter().map(|(reading, _)| *reading).collect();
                let span_s = [run[0].time_s, run[run.len() - 1].time_s];
                if run.len() < FEWEST_IN_RUN || span_s[1] - span_s[0] < SHORTEST_RUN_S {
                    continue;
                }
                let fits = |prism: Prism| {
                    let error_m = error_m(station, &run, Some(prism))?;
                    (error_m < limit_m).then_some((prism, error_m))
                };
                let followed = schedule.at(span_s[0])[station];
                let best = (0..prisms).map(Prism::at).filter_map(fits);
                let best = best.min_by(|(_, a_m), (_, b_m)| a_m.total_cmp(b_m));
                runs.push(ContradictingRun {
                    station,
                    span_s,
                    readings: run.len(),
                    error_m: error_m(station, &run, None).unwrap_or(0.0),
                    prism: best.map(|(prism, _)| prism).filter(|prism| *prism != followed),
                });
            }
            let kept = both.iter().filter(|(_, is_kept)| *is_kept);
            let mut kept: Vec<Reading> = kept.map(|(reading, _)| (*reading).clone()).collect();
            kept.shrink_to_fit();
            Arc::new(kept)
        });
        (DriveReadings { tracks, restarts_s: readings.restarts_s.clone() }, runs)
    }
}

/// Verdict on a reading beside those of other stations.
#[derive(Clone, Copy, PartialEq)]
enum ReadingVerdict {
    Fits,
    /// It contradicts a station that fits fewer others.
    Contested,
    /// One other station alone sees the rig, and another prism fits this station's readings better.
    FitsAnotherPrism,
    /// It contradicts a station that fits as many others.
    Contradicts,
}

/// Returns true for each reading that is kept. Runs of readings that do not fit are left out as a whole unless [`LEAST_KEPT`] of them are contested ones. Where
/// another station has an outlier, one on another prism seems to be right, and few readings of a prism determine no motion. Readings of a run are less than
/// `longest_s` apart.
fn kept_by_runs(track: &[Reading], judged: &[ReadingVerdict], longest_s: f64) -> Vec<bool> {
    let mut is_kept: Vec<bool> =
        judged.iter().map(|judgement| *judgement != ReadingVerdict::Contradicts).collect();
    let doubtful: Vec<usize> =
        (0..track.len()).filter(|index| judged[*index] != ReadingVerdict::Fits).collect();
    let longest_s = longest_s.max(SHORTEST_DECIDED_S);
    let is_same_run = |a: &usize, b: &usize| track[*b].time_s - track[*a].time_s <= longest_s;
    for run in doubtful.chunk_by(is_same_run) {
        let [first, last] = [run[0], run[run.len() - 1]];
        let lasts_s = track[last].time_s - track[first].time_s;
        let contested =
            run.iter().filter(|index| judged[**index] == ReadingVerdict::Contested).count();
        let is_long = run.len() >= FEWEST_IN_RUN && lasts_s >= SHORTEST_DECIDED_S;
        if is_long && (contested as f64) < LEAST_KEPT * run.len() as f64 {
            run.iter().for_each(|index| is_kept[*index] = false);
            // Noise makes single readings between them fit the own prism.
            if run.iter().any(|index| judged[*index] == ReadingVerdict::FitsAnotherPrism) {
                is_kept[first..=last].fill(false);
            }
        }
    }
    is_kept
}

/// A track in the frame of station 1.
struct PlacedTrack<'a> {
    track: &'a [Reading],
    transform: &'a LevelTransform,
    longest_s: f64,
}

impl<'a> PlacedTrack<'a> {
    fn new(track: &'a [Reading], transform: &'a LevelTransform) -> Self {
        let step_s = median(track.windows(2).map(|both| both[1].time_s - both[0].time_s));
        Self { track, transform, longest_s: STEPS_APART * step_s.unwrap_or(0.0) }
    }

    /// Returns the position at an instant (m); `None` in a gap.
    fn at(&self, time_s: f64) -> Option<Vector3<f64>> {
        let index = self.track.partition_point(|reading| reading.time_s < time_s);
        let after = self.track.get(index)?;
        if after.time_s == time_s {
            return Some(self.transform.apply(&after.point_m));
        }
        let before = &self.track[index.checked_sub(1)?];
        let apart_s = after.time_s - before.time_s;
        let share = (time_s - before.time_s) / apart_s;
        let point_m = before.point_m.lerp(&after.point_m, share);
        (apart_s <= self.longest_s).then(|| self.transform.apply(&point_m))
    }
}

/// Errors of the distances between the stations that have a position at an instant.
struct InstantErrors {
    /// Two stations, and the error of their distance (m).
    pairs: Vec<([Station; 2], f64)>,
    /// Least error of the own distance if the station followed another prism (m), where one other station alone sees the rig.
    on_another_prism_m: Option<f64>,
}

impl InstantErrors {
    fn new(
        placed: &PerStation<PlacedTrack<'_>>,
        (followed, rig): (&PerStation<Prism>, Option<&Rig>),
        own: Station,
        time_s: f64,
    ) -> Self {
        let position = |(station, track): (Station, &PlacedTrack<'_>)| {
            Some((station, followed[station], track.at(time_s)?))
        };
        let present: Vec<(Station, Prism, Vector3<f64>)> =
            placed.each().filter_map(position).collect();
        let mut errors = Self { pairs: Vec::new(), on_another_prism_m: None };
        // Without the own position, all of its pairs are unknown.
        if present.iter().all(|(station, ..)| *station != own) {
            return errors;
        }
        let error_m = |prisms: [Prism; 2], apart_m: f64| {
            let known_m = match Pair::between(prisms[0], prisms[1]) {
                None => Some(0.0),
                Some(pair) => rig.and_then(|rig| rig.inter_prism_m.get(pair)).copied(),
            };
            known_m.map(|known_m| (apart_m - known_m).abs())
        };
        for (index, (a, prism_a, a_m)) in present.iter().enumerate() {
            for (b, prism_b, b_m) in &present[index + 1..] {
                let error_m = error_m([*prism_a, *prism_b], (a_m - b_m).norm());
                errors.pairs.extend(error_m.map(|error_m| ([*a, *b], error_m)));
            }
        }
        if let [a, b] = &present[..] {
            let other = if a.0 == own { b.1 } else { a.1 };
            let apart_m = (a.2 - b.2).norm();
            let prisms = rig.and_then(|rig| Pair::prisms_of(rig.inter_prism_m.len())).unwrap_or(0);
            let others = (0..prisms).map(Prism::at).filter(|prism| *prism != followed[own]);
            let errors_m = others.filter_map(|prism| error_m([prism, other], apart_m));
            errors.on_another_prism_m = errors_m.reduce(f64::min);
        }
        errors
    }

    /// Returns the largest error of a station's distances (m); `None` for a station alone.
    fn worst_m(&self, station: Station) -> Option<f64> {
        self.errors_m(station).reduce(f64::max)
    }

    /// Number of a station's distances that fit.
    fn fitting(&self, station: Station, limit_m: f64) -> usize {
        self.errors_m(station).filter(|error_m| *error_m < limit_m).count()
    }

    /// Errors of a station's distances (m).
    fn errors_m(&self, station: Station) -> impl Iterator<Item = f64> {
        let pairs = self.pairs.iter().filter(move |(stations, _)| stations.contains(&station));
        pairs.map(|(_, error_m)| *error_m)
    }

    fn judged(&self, station: Station, limit_m: f64) -> ReadingVerdict {
        if !self.is_kept(station, limit_m) {
            return ReadingVerdict::Contradicts;
        }
        let Some(worst_m) = self.worst_m(station) else { return ReadingVerdict::Fits };
        let clear_m = (CLEARLY_LESS * worst_m).min(worst_m - CLEAR_SHARE * limit_m);
        if self.on_another_prism_m.is_some_and(|error_m| error_m < clear_m) {
            ReadingVerdict::FitsAnotherPrism
        } else if worst_m >= limit_m {
            ReadingVerdict::Contested
        } else {
            ReadingVerdict::Fits
        }
    }

    fn is_kept(&self, station: Station, limit_m: f64) -> bool {
        let fitting = self.fitting(station, limit_m);
        let contradicts = |(stations, error_m): &([Station; 2], f64)| {
            stations.contains(&station)
                && *error_m >= limit_m
                && stations
                    .iter()
                    .any(|other| *other != station && self.fitting(*other, limit_m) >= fitting)
        };
        !self.pairs.iter().any(contradicts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Readings at 20 Hz, as they are judged alone: `k` fits, `c` is contested, `a` fits another prism, and `-` is left out.
    fn kept(judged: &str) -> String {
        let reading = |index: usize| Reading { time_s: 0.05 * index as f64, point_m: Vector3::x() };
        let track: Vec<Reading> = (0..judged.len()).map(reading).collect();
        let judged = judged
            .chars()
            .map(|c| match c {
                'k' => ReadingVerdict::Fits,
                'c' => ReadingVerdict::Contested,
                'a' => ReadingVerdict::FitsAnotherPrism,
                _ => ReadingVerdict::Contradicts,
            })
            .collect::<Vec<_>>();
        let is_kept = kept_by_runs(&track, &judged, 0.125);
        is_kept.into_iter().map(|is_kept| if is_kept { 'k' } else { '-' }).collect()
    }

    #[test]
    fn readings_within_a_run_on_another_prism_are_left_out_with_it() {
        assert_eq!(kept("kkk---------cc---------kkk"), "kkk--------------------kkk");
        // A station that is right while another one is on a wrong prism, and single outliers.
        assert_eq!(kept("kkkcccccccccc-cccccccccckkk"), "kkkkkkkkkkkkk-kkkkkkkkkkkkk");
        assert_eq!(kept("kk-ckkkkkkkkkkkkkkkkkk--ckk"), "kk-kkkkkkkkkkkkkkkkkkk--kkk");
        // Beside one other station; noise alone makes another prism fit single readings.
        assert_eq!(kept("kkkaaakaakaaaakkkkkkkkkkkkk"), "kkk-----------kkkkkkkkkkkkk");
        assert_eq!(kept("kkkakkkkkkkkkkkkkkaakkkkkkk"), "kkkkkkkkkkkkkkkkkkkkkkkkkkk");
    }
}
