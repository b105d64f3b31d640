//! What the containers hand their messages to: it fills the recording, and keeps count of what was lost on the way.

use nalgebra::Vector3;

use super::OpenError;
use super::inflate::{self, ZSTD_MAGIC};
use super::messages::{Coords, Kind, Message, Point, StampedPose, decode, short_type};
use super::wire::Encoding;
use crate::deployment::station_clocks::Arrivals;
use crate::deployment::{Finding, Measurement, RawRecord, Recording, TimeCorrection};
use crate::geometry::Polar;
use crate::progress::Progress;

/// No message that is read comes near this; a longer one is left out as malformed.
pub const LARGEST_MESSAGE_BYTES: usize = 1 << 16;
/// Most topics that are read, more than any robot has; those beyond are not.
const MOST_TOPICS: usize = 1000;

/// A topic whose messages are wanted.
#[derive(Clone, Copy, Debug)]
pub struct Subscription {
    kind: Kind,
    encoding: Encoding,
    /// Index of the topic in `Intake::topics`.
    topic: usize,
}

/// A topic of any type, over all pieces.
#[derive(Debug)]
pub struct SeenTopic {
    pub name: String,
    pub message_type: String,
    pub kind: Option<Kind>,
    pub messages: u64,
    /// The station that the user says it is, 0 to 2.
    pub station: Option<usize>,
}

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
    /// Topics of stations 1, 2, 3, where the user names them.
    pub(super) named: Option<&'a [String; 3]>,
    progress: &'a Progress,
    pub(super) files: Vec<String>,
    file_bytes: u64,
    reported: u64,
    pub(super) topics: Vec<SeenTopic>,
    /// Wanted messages of this file so far: what a place in it is counted by.
    place: usize,
    losses: Losses,
    /// When the first and the last message of this file were recorded (s).
    span_s: Option<[f64; 2]>,
    pub(super) readings: u64,
    /// Theodolite messages that the topics which the user names stand for.
    pub(super) stood_in_for: u64,
    pub(super) without_stamp: [u64; 3],
    pub(super) without_any_time: [u64; 3],
    pub(super) arrivals: Arrivals,
    inflated: Vec<u8>,
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
            named,
            progress,
            files: Vec::new(),
            file_bytes: 0,
            reported: 0,
            topics: Vec::new(),
            place: 0,
            losses: Losses::default(),
            span_s: None,
            readings: 0,
            stood_in_for: 0,
            without_stamp: [0; 3],
            without_any_time: [0; 3],
            arrivals: Arrivals::default(),
            inflated: Vec::new(),
            poses: None,
        }
    }

    /// Takes in poses of other systems, and no readings.
    pub fn of_poses(into: &'a mut Recording, progress: &'a Progress) -> Self {
        Self { poses: Some(Vec::new()), ..Self::new(into, None, progress) }
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
        let kind = Kind::of_type(message_type);
        let kind = kind.filter(|kind| kind.is_pose() == self.poses.is_some());
        let known = self.topics.iter().position(|t| t.name == name && t.kind == kind);
        if known.is_none() && self.topics.len() >= MOST_TOPICS {
            return None;
        }
        let topic = known.unwrap_or_else(|| {
            let station = self.named.and_then(|named| named.iter().position(|own| own == name));
            self.topics.push(SeenTopic {
                name: name.to_owned(),
                message_type: short_type(message_type),
                kind,
                messages: 0,
                station: station.filter(|_| kind.is_some_and(Kind::is_position)),
            });
            self.topics.len() - 1
        });
        kind.map(|kind| Subscription { kind, encoding, topic })
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
        let Subscription { kind, encoding, topic } = subscription;
        self.topics[topic].messages += 1;
        let mut inflated = std::mem::take(&mut self.inflated);
        let message = if data.starts_with(&ZSTD_MAGIC) {
            match inflate::message(data, LARGEST_MESSAGE_BYTES, &mut inflated) {
                Ok(()) => Ok(inflated.as_slice()),
                Err(error) => Err(format!("cannot be inflated ({error})")),
            }
        } else {
            Ok(data)
        };
        let decoded = message.and_then(|message| {
            decode(kind, encoding, message).map_err(|error| format!("is malformed: {error}"))
        });
        self.inflated = inflated;
        match decoded {
            Ok(Message::Coords(_)) if self.named.is_some() => self.stood_in_for += 1,
            Ok(Message::Coords(coords)) => self.coords(&coords, recorded_s),
            Ok(Message::Correction(correction)) => {
                let time_s = correction.stamp_s.unwrap_or(recorded_s);
                let correction_of = TimeCorrection { time_s, offset_s: correction.offset_s };
                self.into.push_correction(i64::from(correction.station), correction_of);
            }
            Ok(Message::Point(point)) => {
                if let Some(station) = self.topics[topic].station {
                    self.point(station, &point, recorded_s);
                }
            }
            Ok(Message::Pose(pose)) => {
                if let Some(poses) = &mut self.poses {
                    poses.resize_with(poses.len().max(topic + 1), Vec::new);
                    // Who sets no stamp is taken at the time of the recorder, as readings are.
                    let stamp_s = pose.stamp_s.or(Some(recorded_s));
                    poses[topic].push(StampedPose { stamp_s, ..pose });
                }
            }
            Err(why) => self.malformed(topic, &why),
        }
        Ok(())
    }

    /// A message that is longer than any can be.
    pub fn overlong_message(&mut self, subscription: Subscription, bytes: u64) {
        self.place += 1;
        let why = format!("has {bytes} bytes (the limit is {LARGEST_MESSAGE_BYTES})");
        self.malformed(subscription.topic, &why);
    }

    fn malformed(&mut self, topic: usize, why: &str) {
        self.losses.malformed += 1;
        let (place, name) = (self.place, &self.topics[topic].name);
        self.losses
            .first_malformed
            .get_or_insert_with(|| format!("message {place}, of {name}, {why}"));
    }

    fn coords(&mut self, coords: &Coords, recorded_s: f64) {
        let number = i64::from(coords.station);
        let station = self.into.station_of(number);
        let count = |counts: &mut [u64; 3]| {
            if let Some(station) = station.filter(|_| coords.status == 0) {
                counts[station] += 1;
            }
        };
        let (time_s, own_clock_s) = match (coords.stamp_s, coords.own_clock_s) {
            (Some(stamp_s), own_clock_s) => (stamp_s, own_clock_s),
            (None, Some(own_clock_s)) => {
                count(&mut self.without_stamp);
                (own_clock_s, None)
            }
            (None, None) => {
                count(&mut self.without_any_time);
                (recorded_s, None)
            }
        };
        if let (Some(station), Some(own_clock_s)) = (station, own_clock_s) {
            self.arrivals.push(station, recorded_s - time_s, recorded_s - own_clock_s);
        }
        self.readings += 1;
        self.into.push(&RawRecord {
            station: number,
            status: i64::from(coords.status),
            place: self.place,
            own_clock_s,
            measurement: Measurement {
                time_s,
                azimuth_rad: coords.azimuth_rad,
                zenith_rad: coords.zenith_rad,
                range_m: coords.range_m,
            },
        });
    }

    fn point(&mut self, station: usize, point: &Point, recorded_s: f64) {
        if point.stamp_s.is_none() {
            self.without_any_time[station] += 1;
        }
        let polar = Polar::from_cartesian(Vector3::from(point.position_m));
        self.readings += 1;
        self.into.ranges_include_prism_constant = true;
        self.into.push(&RawRecord {
            station: station as i64 + 1,
            status: 0,
            place: self.place,
            own_clock_s: None,
            measurement: Measurement {
                time_s: point.stamp_s.unwrap_or(recorded_s),
                range_m: polar.range_m,
                azimuth_rad: polar.azimuth_rad,
                zenith_rad: polar.zenith_rad,
            },
        });
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

    /// Something about the file that cost nothing.
    pub fn note(&mut self, what: &str) {
        let note = Finding::note(format!("{}: {what}", self.file()));
        self.into.findings.push(note);
    }

    /// Says what was lost of the file.
    pub fn end_file(&mut self) -> Result<(), OpenError> {
        self.done(1.0)?;
        let (losses, file) = (std::mem::take(&mut self.losses), self.file().to_owned());
        if let Some(first) = &losses.first {
            let more = match losses.count {
                1 => String::new(),
                2 => ", and one more place".to_owned(),
                count => format!(", and {} more places", count - 1),
            };
            let bytes = match losses.bytes {
                0 => String::new(),
                bytes => format!("; {bytes} bytes could not be read"),
            };
            self.into.findings.push(Finding::warning(format!(
                "{file}: {first}{more}{bytes}; what could be saved is {} messages",
                self.place
            )));
        }
        if let Some(first) = losses.first_malformed {
            self.into.findings.push(Finding::warning(format!(
                "{file}: {} messages left out; the first: {first}",
                losses.malformed
            )));
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
