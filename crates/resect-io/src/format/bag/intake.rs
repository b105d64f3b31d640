//! Receiver of the containers' messages: adds them to the recording, and counts losses.

use super::messages::{NavSatFix, StampedPose};
use super::stream::{Heard, Stream};
pub use super::stream::{LARGEST_MESSAGE_BYTES, Subscription};
use super::transform_tree::TransformTree;
use super::wire::Encoding;
use crate::error::OpenError;
use crate::findings::bags::{self, bag_damaged, bag_incomplete, bag_messages_malformed};
use crate::recording::Recording;
use resect_core::network::PerStation;
use resect_core::progress::Progress;

/// Losses of one file.
#[derive(Debug, Default)]
struct FileLosses {
    /// Description of the first.
    first: Option<String>,
    count: u64,
    bytes: u64,
    malformed: u64,
    first_malformed: Option<String>,
}

/// Receives the messages of one bag, or of the files of one recording one after the other.
pub struct Intake<'a> {
    pub(super) into: &'a mut Recording,
    pub(super) stream: Stream,
    progress: &'a Progress,
    pub(super) files: Vec<String>,
    file_bytes: u64,
    reported: u64,
    /// Number of wanted messages of this file so far: the place of the current one.
    place: usize,
    losses: FileLosses,
    /// Recording times of the first and the last message of this file (s).
    span_s: Option<[f64; 2]>,
    /// Poses by index of the topic; `None` if readings are wanted instead.
    pub(super) poses: Option<Vec<Vec<StampedPose>>>,
    pub(super) transforms: TransformTree,
    /// Fixes by index of the topic, as the poses.
    pub(super) fixes: Vec<Vec<NavSatFix>>,
}

impl<'a> Intake<'a> {
    pub fn new(
        into: &'a mut Recording,
        named: Option<&'a PerStation<String>>,
        progress: &'a Progress,
    ) -> Self {
        into.expect_stations(named.map_or(0, PerStation::len));
        for (station, topic) in named.into_iter().flatten().enumerate() {
            into.name_station(station, topic);
        }
        Self {
            into,
            stream: Stream::of_readings(named.cloned()),
            progress,
            files: Vec::new(),
            file_bytes: 0,
            reported: 0,
            place: 0,
            losses: FileLosses::default(),
            span_s: None,
            poses: None,
            transforms: TransformTree::default(),
            fixes: Vec::new(),
        }
    }

    /// Receives poses of other systems, and no readings.
    pub fn of_poses(into: &'a mut Recording, progress: &'a Progress) -> Self {
        let stream = Stream::of_poses();
        Self { stream, poses: Some(Vec::new()), ..Self::new(into, None, progress) }
    }

    pub fn begin_file(&mut self, file: &str, bytes: u64) {
        self.into.begin_file(file, "message");
        self.files.push(file.to_owned());
        (self.file_bytes, self.reported, self.place) = (bytes, 0, 0);
        (self.losses, self.span_s) = (FileLosses::default(), None);
    }

    /// Name of the current file.
    pub fn file(&self) -> &str {
        self.files.last().map_or("", String::as_str)
    }

    pub fn progress(&self) -> &'a Progress {
        self.progress
    }

    /// Recording times of the first and the last message of the file (s, the recorder's clock), over all topics that are read.
    pub fn span_s(&self) -> Option<[f64; 2]> {
        self.span_s
    }

    /// Reports the share of the file that has been read.
    pub fn done(&mut self, share: f64) -> Result<(), OpenError> {
        let done = (self.file_bytes as f64 * share.clamp(0.0, 1.0)) as u64;
        let more = done.saturating_sub(self.reported);
        self.reported += more;
        Ok(self.progress.advance(more)?)
    }

    /// Registers a topic of the file; returns `None` if its messages are not wanted.
    pub fn topic(
        &mut self,
        name: &str,
        message_type: &str,
        encoding: Encoding,
    ) -> Option<Subscription> {
        self.stream.topic(name, message_type, encoding)
    }

    /// Receives a message, recorded at `recorded_s` (s). A damaged one is counted, never an error.
    pub fn message(
        &mut self,
        subscription: Subscription,
        recorded_s: f64,
        data: &[u8],
    ) -> Result<(), OpenError> {
        self.progress.check()?;
        self.place += 1;
        let span_s = self.span_s.get_or_insert([recorded_s; 2]);
        *span_s = [span_s[0].min(recorded_s), span_s[1].max(recorded_s)];
        match self.stream.message(subscription, recorded_s, self.place, data, self.into) {
            Ok(Heard::Pose { topic, pose }) => {
                if let Some(poses) = &mut self.poses {
                    poses.resize_with(poses.len().max(topic + 1), Vec::new);
                    // Poses without a stamp get the recorder's time, as readings do.
                    let stamp_s = pose.stamp_s.or(Some(recorded_s));
                    poses[topic].push(StampedPose { stamp_s, ..pose });
                }
            }
            Ok(Heard::Fix { topic, fix }) => {
                if self.poses.is_some() {
                    self.fixes.resize_with(self.fixes.len().max(topic + 1), Vec::new);
                    let stamp_s = fix.stamp_s.or(Some(recorded_s));
                    self.fixes[topic].push(NavSatFix { stamp_s, ..fix });
                }
            }
            Ok(Heard::Transforms(transforms)) => {
                transforms
                    .into_iter()
                    .for_each(|transform| self.transforms.add(transform, recorded_s));
            }
            Ok(Heard::Record(_) | Heard::Correction { .. } | Heard::NotTaken) => {}
            Err(why) => self.malformed(subscription, &why),
        }
        Ok(())
    }

    /// Counts a message that is longer than any valid one.
    pub fn overlong_message(&mut self, subscription: Subscription, bytes: u64) {
        self.place += 1;
        let why = format!("has {bytes} bytes (the limit is {LARGEST_MESSAGE_BYTES})");
        self.malformed(subscription, &why);
    }

    fn malformed(&mut self, subscription: Subscription, why: &str) {
        self.losses.malformed += 1;
        let (place, name) = (self.place, self.stream.name(subscription));
        self.losses
            .first_malformed
            .get_or_insert_with(|| format!("message {place}, of {name}, {why}"));
    }

    /// Counts `bytes` of the file as lost; `why` is the reason with its place.
    pub fn lost(&mut self, bytes: u64, why: impl Into<String>) {
        self.losses.count += 1;
        self.losses.bytes += bytes;
        if self.losses.first.is_none() {
            let place = self.place;
            let after = match self.span_s {
                Some([first_s, last_s]) => {
                    format!(", after message {place}, {:.1} s into the recording", last_s - first_s)
                }
                None => ", before any message".to_owned(),
            };
            self.losses.first = Some(format!("{}{after}", why.into()));
        }
    }

    /// Adds a finding about an interrupted recording that was read completely.
    pub fn note(&mut self, what: &str) {
        let note = bag_incomplete(self.file(), what);
        self.into.findings.push(note);
    }

    /// Ends the file, and adds findings about its losses.
    pub fn end_file(&mut self) -> Result<(), OpenError> {
        self.done(1.0)?;
        let (losses, file) = (std::mem::take(&mut self.losses), self.file().to_owned());
        if let Some(first) = &losses.first {
            let (count, bytes, messages) = (losses.count, losses.bytes, self.place);
            let count = count as usize;
            let losses = bags::Losses { first, count, bytes, messages };
            self.into.findings.push(bag_damaged(&file, &losses));
        }
        if let Some(first) = losses.first_malformed {
            let finding = bag_messages_malformed(&file, losses.malformed as usize, &first);
            self.into.findings.push(finding);
        }
        Ok(())
    }
}

/// Returns a key that sorts names by the numbers in them: 2 before 10.
pub fn natural_key(name: &str) -> Vec<(String, u64)> {
    let mut key = Vec::new();
    let mut rest = name;
    while !rest.is_empty() {
        let digits_from = rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len());
        let (text, tail) = rest.split_at(digits_from);
        let digits_to = tail.find(|c: char| !c.is_ascii_digit()).unwrap_or(tail.len());
        let (digits, tail) = tail.split_at(digits_to);
        key.push((text.to_owned(), digits.parse().unwrap_or(u64::MAX)));
        rest = tail;
    }
    key
}
