//! A deployment whose readings are still coming: everything else is read once, and the tracks are what was heard so far.
//!
//! [`Growing::deployment`] makes the same of the messages as a bag of them makes when it is opened.

use std::path::Path;

use super::format::bag::stream::{Heard, Stream, Subscription};
use super::format::bag::wire::Encoding;
use super::open::tracks_of_recording;
use crate::error::OpenError;
use crate::extras::Extras;
use crate::open;
use crate::recording::Recording;
use resect_core::deployment::{Deployment, FindingKind, Overrides, Track};
use resect_core::progress::Progress;

/// Where readings come from, in findings.
const STREAM: &str = "the live stream";

/// What is known beforehand, and what was heard since.
#[derive(Clone, Debug)]
pub struct Growing {
    /// All but what the readings say.
    around: Deployment,
    /// What the readings are taken with.
    overrides: Overrides,
    put_right: Overrides,
    recording: Recording,
    stream: Stream,
    messages: usize,
}

impl Growing {
    /// Begins with what lies in a folder (rig, control points, `deployment.toml`; no tracks), and with what the user names.
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
        Ok(Self::new(around, overrides, found.put_right))
    }

    /// Begins with all but the readings of a deployment, which come again from elsewhere; `put_right` is said of those.
    pub fn of_readings_again(mut deployment: Deployment, put_right: &Overrides) -> Self {
        deployment.tracks = Default::default();
        // What is added to ranges is said again of the readings that come.
        deployment.findings.retain(|finding| finding.kind != FindingKind::PrismConstantAdded);
        // They come as they were read: what was said of that is done.
        deployment.as_read = deployment.as_read.beside_readings();
        deployment.overrides = put_right.clone().over(deployment.as_read.clone());
        Self::new(deployment, put_right.clone(), put_right.clone())
    }

    fn new(around: Deployment, overrides: Overrides, put_right: Overrides) -> Self {
        let counter_clockwise = overrides.is_counter_clockwise();
        let mut recording = Recording::new(overrides.stations, counter_clockwise);
        recording.begin_file(STREAM, "message");
        let stream = Stream::of_readings(overrides.topics.clone());
        Self { around, overrides, put_right, recording, stream, messages: 0 }
    }

    /// Takes all but the readings from another, and reads those that came, and those that will come, as that one does. Gives which
    /// station each was before; `None` for one that none was.
    pub fn read_with(&mut self, other: Self) -> [Option<usize>; 3] {
        let counter_clockwise = other.overrides.is_counter_clockwise();
        (self.around, self.overrides, self.put_right) =
            (other.around, other.overrides, other.put_right);
        self.recording.count_as(self.overrides.stations, counter_clockwise)
    }

    /// Says of a topic what it is; `None` where its messages are not wanted.
    pub fn topic(&mut self, name: &str, kind: &str, encoding: Encoding) -> Option<Subscription> {
        self.stream.topic(name, kind, encoding)
    }

    /// Takes in a message that was sent at `recorded_s`.
    ///
    /// # Errors
    /// What is wrong with the message, as one line; it is left out.
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

    /// What is added to the ranges of messages that name their station (m).
    pub fn added_to_ranges_m(&self) -> [f64; 3] {
        match self.overrides.ranges_include_prism_constant {
            Some(true) => [0.0; 3],
            _ => self.overrides.prism_constant_m.unwrap_or_default().each_m(),
        }
    }

    /// The station, 0 to 2, that has this number in the messages.
    pub fn station_of(&self, number: i64) -> Option<usize> {
        self.recording.station_of(number)
    }

    /// The tracks so far, in order of time.
    pub fn tracks(&mut self) -> &[Track; 3] {
        self.recording.settle();
        self.recording.tracks()
    }

    /// How many readings of each station came late, and how many were repeated.
    pub fn late_and_repeated(&self) -> [[usize; 2]; 3] {
        self.recording.late_and_repeated()
    }

    /// How many records could not be readings.
    pub fn dropped(&self) -> usize {
        self.recording.dropped()
    }

    /// Topics with positions whose station nobody says.
    pub fn topics_of_no_station(&self) -> Vec<String> {
        self.stream.positions_of_no_station().iter().map(|topic| topic.name.clone()).collect()
    }

    /// What is known of the rig beforehand, and all else that is no reading.
    pub fn known_beforehand(&self) -> &Deployment {
        &self.around
    }

    /// The deployment as it is so far; an error before the first reading, and where the numbers cannot be readings.
    pub fn deployment(&mut self) -> Result<Deployment, OpenError> {
        self.recording.settle();
        let recording = self.recording.clone();
        let read = tracks_of_recording(recording, STREAM, &self.put_right, &self.overrides)?;
        let mut deployment = self.around.clone();
        let findings = &mut deployment.findings;
        findings.extend(self.stream.findings());
        findings.extend(read.findings);
        findings.extend(read.about_prism_constant);
        deployment.tracks = read.tracks;
        for (track, told) in deployment.time_corrections.iter_mut().zip(read.time_corrections) {
            track.extend(told);
        }
        Ok(deployment)
    }
}
