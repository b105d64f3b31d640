//! A deployment whose readings are still arriving: everything else is read once, the tracks grow with each message.
//!
//! [`Growing::deployment`] returns the same as opening a bag with the same messages.

use crate::findings::kinds;
use std::path::Path;

use super::format::bag::stream::{Heard, Stream, Subscription};
use super::format::bag::wire::Encoding;
use super::open::{complete_stations, tracks_of_recording};
use crate::error::OpenError;
use crate::extras::Extras;
use crate::open;
use crate::recording::Recording;
use resect_core::deployment::{Deployment, Overrides, Track};
use resect_core::network::{MOST_STATIONS, PerStation, USUAL_STATIONS};
use resect_core::progress::Progress;

/// Source of the readings in findings.
const STREAM: &str = "the live stream";

/// A deployment without tracks, and the readings received so far.
#[derive(Clone, Debug)]
pub struct Growing {
    /// Everything but the readings.
    around: Deployment,
    /// Overrides applied to the readings.
    overrides: Overrides,
    corrections: Overrides,
    recording: Recording,
    stream: Stream,
    messages: usize,
}

impl Growing {
    /// Starts from a folder (rig, control points, `deployment.toml`; no tracks) and the files that the user names.
    pub fn around(
        name: &str,
        folder: Option<&Path>,
        extras: &Extras,
        progress: &Progress,
    ) -> Result<Self, OpenError> {
        let mut found = match folder {
            Some(folder) => open::find(folder, progress)?,
            None => open::in_memory(name, &[]),
        };
        found.chosen = None;
        found.add(extras)?;
        let around = open::combine_without_tracks(&found, progress)?;
        let overrides = around.overrides.clone();
        Ok(Self::new(around, overrides, found.corrections))
    }

    /// Starts from a deployment without its readings, which arrive again from elsewhere; `corrections` applies to them.
    pub fn of_readings_again(mut deployment: Deployment, corrections: &Overrides) -> Self {
        deployment.tracks = deployment.tracks.map(|_| Track::default());
        // This finding is repeated for the new readings.
        deployment.findings.retain(|finding| finding.kind != kinds::PRISM_CONSTANT_ADDED);
        // The readings arrive as they were read, with the overrides about reading already applied.
        deployment.as_read = deployment.as_read.beside_readings();
        deployment.overrides = corrections.clone().over(deployment.as_read.clone());
        Self::new(deployment, corrections.clone(), corrections.clone())
    }

    fn new(around: Deployment, overrides: Overrides, corrections: Overrides) -> Self {
        let counter_clockwise = overrides.is_counter_clockwise();
        let mut recording = Recording::new(overrides.stations.as_ref(), counter_clockwise);
        recording.begin_file(STREAM, "message");
        if around.tracks.len() != USUAL_STATIONS {
            recording.expect_stations(around.tracks.len());
        }
        let stream = Stream::of_readings(overrides.topics.clone());
        Self { around, overrides, corrections, recording, stream, messages: 0 }
    }

    /// Replaces everything but the readings, and re-reads all of them with the other's overrides. Returns the former index of each
    /// station; `None` for a new one.
    pub fn read_with(&mut self, other: Self) -> PerStation<Option<usize>> {
        let counter_clockwise = other.overrides.is_counter_clockwise();
        (self.around, self.overrides, self.corrections) =
            (other.around, other.overrides, other.corrections);
        self.recording.count_as(self.overrides.stations.as_ref(), counter_clockwise)
    }

    /// States that there are at least this many stations, even without readings.
    pub fn expect_stations(&mut self, count: usize) {
        self.recording.expect_stations(count);
    }

    /// Registers a topic; returns `None` if its messages are not wanted.
    pub fn topic(&mut self, name: &str, kind: &str, encoding: Encoding) -> Option<Subscription> {
        self.stream.topic(name, kind, encoding)
    }

    /// Adds a message that was sent at `recorded_s` (s).
    ///
    /// # Errors
    /// The fault of a malformed message, as one line; the message is ignored.
    pub fn message(
        &mut self,
        subscription: Subscription,
        recorded_s: f64,
        data: &[u8],
    ) -> Result<Heard, String> {
        self.messages += 1;
        let (place, into) = (self.messages, &mut self.recording);
        self.stream
            .message(subscription, recorded_s, place, data, into)
            .map_err(|why| format!("message {place}, of {}, {why}", self.stream.name(subscription)))
    }

    /// Prism constants added to the ranges of messages that name their station (m).
    pub fn added_to_ranges_m(&self) -> PerStation<f64> {
        match self.overrides.ranges_include_prism_constant {
            Some(true) => PerStation::repeat(MOST_STATIONS, 0.0),
            _ => self.overrides.prism_constant_m.clone().unwrap_or_default().each_m(MOST_STATIONS),
        }
    }

    /// Returns the station, from 0, with this number in the messages.
    pub fn station_of(&self, number: i64) -> Option<usize> {
        self.recording.station_of(number)
    }

    /// Tracks so far, in order of time.
    pub fn tracks(&mut self) -> impl ExactSizeIterator<Item = &Track> {
        self.recording.settle();
        self.recording.tracks()
    }

    /// Number of late and of repeated readings, for each station.
    pub fn late_and_repeated(&self) -> PerStation<[usize; 2]> {
        self.recording.late_and_repeated()
    }

    /// Number of records that cannot be readings.
    pub fn dropped(&self) -> usize {
        self.recording.dropped()
    }

    /// Topics with positions whose station is unknown.
    pub fn topics_of_no_station(&self) -> Vec<String> {
        self.stream.positions_of_no_station().iter().map(|topic| topic.name.clone()).collect()
    }

    /// The deployment without its readings.
    pub fn known_beforehand(&self) -> &Deployment {
        &self.around
    }

    /// Returns the deployment so far; an error before the first reading, or if the numbers cannot be readings.
    pub fn deployment(&mut self) -> Result<Deployment, OpenError> {
        self.recording.settle();
        let recording = self.recording.clone();
        let read = tracks_of_recording(recording, STREAM, &self.corrections, &self.overrides)?;
        let mut deployment = self.around.clone();
        let findings = &mut deployment.findings;
        findings.extend(self.stream.findings());
        findings.extend(read.findings);
        findings.extend(read.about_prism_constant);
        deployment.tracks = read.tracks;
        for (station, told) in read.time_corrections.into_iter().enumerate() {
            let known = deployment.time_corrections.len();
            deployment.time_corrections.resize_with(known.max(station + 1), Vec::new);
            deployment.time_corrections[station].extend(told);
        }
        complete_stations(&mut deployment, STREAM)?;
        Ok(deployment)
    }
}
