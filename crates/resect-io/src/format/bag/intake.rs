//! What the containers hand their messages to: it fills the recording, and keeps count of what was lost on the way.

use super::messages::StampedPose;
use super::stream::{Heard, Stream};
pub use super::stream::{LARGEST_MESSAGE_BYTES, Subscription};
use super::wire::Encoding;
use crate::error::OpenError;
use crate::findings::bags::{self, bag_damaged, bag_incomplete, bag_messages_malformed};
use crate::recording::Recording;
use resect_core::progress::Progress;

/// What could not be read of one file.
#[derive(Debug, Default)]
struct Losses {
    /// The first, in words.
    first: Option<String>,
    count: u64,
    bytes: u64,
    malformed: u64,
    first_malformed: Option<String>,
}

/// Takes in the messages of one bag, or of the pieces of one recording after each other.
pub struct Intake<'a> {
    pub(super) into: &'a mut Recording,
    pub(super) stream: Stream,
    progress: &'a Progress,
    pub(super) files: Vec<String>,
    file_bytes: u64,
    reported: u64,
    /// Wanted messages of this file so far: what a place in it is counted by.
    place: usize,
    losses: Losses,
    /// When the first and the last message of this file were recorded (s).
    span_s: Option<[f64; 2]>,
    /// The poses of each topic, by its index, where poses are wanted and not readings.
    pub(super) poses: Option<Vec<Vec<StampedPose>>>,
}

impl<'a> Intake<'a> {
    pub fn new(
        into: &'a mut Recording,
        named: Option<&'a [String; 3]>,
        progress: &'a Progress,
    ) -> Self {
        Self {
            into,
            stream: Stream::of_readings(named.cloned()),
            progress,
            files: Vec::new(),
            file_bytes: 0,
            reported: 0,
            place: 0,
            losses: Losses::default(),
            span_s: None,
            poses: None,
        }
    }

    /// Takes in poses of other systems, and no readings.
    pub fn of_poses(into: &'a mut Recording, progress: &'a Progress) -> Self {
        let stream = Stream::of_poses();
        Self { stream, poses: Some(Vec::new()), ..Self::new(into, None, progress) }
    }

    pub fn begin_file(&mut self, file: &str, bytes: u64) {
        self.into.begin_file(file, "message");
        self.files.push(file.to_owned());
        (self.file_bytes, self.reported, self.place) = (bytes, 0, 0);
        (self.losses, self.span_s) = (Losses::default(), None);
    }

    /// The name of the file that is being read.
    pub fn file(&self) -> &str {
        self.files.last().map_or("", String::as_str)
    }

    pub fn progress(&self) -> &'a Progress {
        self.progress
    }

    /// When the first and the last message of the file were recorded (s, the recorder's clock), of any topic that is read.
    pub fn span_s(&self) -> Option<[f64; 2]> {
        self.span_s
    }

    /// Tells the progress that this share of the file is done.
    pub fn done(&mut self, share: f64) -> Result<(), OpenError> {
        let done = (self.file_bytes as f64 * share.clamp(0.0, 1.0)) as u64;
        let more = done.saturating_sub(self.reported);
        self.reported += more;
        Ok(self.progress.advance(more)?)
    }

    /// Says of a topic of the file what it is; `None` where its messages are not wanted.
    pub fn topic(
        &mut self,
        name: &str,
        message_type: &str,
        encoding: Encoding,
    ) -> Option<Subscription> {
        self.stream.topic(name, message_type, encoding)
    }

    /// Takes in a message, recorded at `recorded_s`. A damaged one is counted, never an error.
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
                    // Who sets no stamp is taken at the time of the recorder, as readings are.
                    let stamp_s = pose.stamp_s.or(Some(recorded_s));
                    poses[topic].push(StampedPose { stamp_s, ..pose });
                }
            }
            Ok(_) => {}
            Err(why) => self.malformed(subscription, &why),
        }
        Ok(())
    }

    /// A message that is longer than any can be.
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

    /// `bytes` of the file could not be read; `why` says it with the place.
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

    /// Notes what an interrupted recording left of the file, all of which was read.
    pub fn note(&mut self, what: &str) {
        let note = bag_incomplete(self.file(), what);
        self.into.findings.push(note);
    }

    /// Says what was lost of the file.
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

/// Orders names by the numbers in them: 2 before 10.
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
