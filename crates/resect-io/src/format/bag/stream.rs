//! Conversion of messages, from a recording or live, into readings of the tracks, and findings about the others.

use crate::findings::bags::{
    positions_in_instrument_frames, positions_not_read, readings_without_stamp,
    readings_without_time, theodolite_messages_not_read, topic_without_positions,
};
use nalgebra::Vector3;
use resect_core::network::{MOST_STATIONS, PerStation};

use super::inflate::{self, ZSTD_MAGIC};
use super::json_messages;
use super::messages::{
    Coords, Kind, Message, NavSatFix, Point, StampedPose, StampedTransform, decode, short_type,
};
use super::wire::Encoding;
use crate::recording::Recording;
use resect_core::deployment::station_clocks::Arrivals;
use resect_core::deployment::{Finding, Measurement, RawRecord, TimeCorrection};
use resect_core::geometry::Polar;

/// Limit for messages, far above the size of those that are read; longer ones are left out as malformed.
pub const LARGEST_MESSAGE_BYTES: usize = 1 << 16;
/// Limit for topics, above that of any robot; further ones are not read.
const MOST_TOPICS: usize = 1000;

/// A topic with messages that are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Subscription {
    kind: Kind,
    encoding: Encoding,
    /// Index of the topic in `Stream::topics`.
    topic: usize,
}

/// A topic of any type, over all files of a recording.
#[derive(Clone, Debug)]
pub struct SeenTopic {
    pub name: String,
    pub message_type: String,
    pub kind: Option<Kind>,
    pub messages: u64,
    /// The station (from 0) that the user assigned.
    pub station: Option<usize>,
}

/// Content of one message.
#[derive(Clone, Debug, PartialEq)]
pub enum Heard {
    /// A reading, or a station's report of none; the recording has stored it, or counted the reason why not.
    Record(RawRecord),
    /// Correction of the clock of a station (from 0).
    Correction {
        station: Option<usize>,
        correction: TimeCorrection,
    },
    Pose {
        topic: usize,
        pose: StampedPose,
    },
    Transforms(Vec<StampedTransform>),
    Fix {
        topic: usize,
        fix: NavSatFix,
    },
    /// A position of an unknown station, or a reading replaced by those of the topics that the user names.
    NotTaken,
}

/// Topics of a recording or of a live stream, and counts of their messages.
#[derive(Clone, Debug)]
pub struct Stream {
    /// Topics of stations 1, 2, …, if the user names them.
    pub named: Option<PerStation<String>>,
    wants_poses: bool,
    pub topics: Vec<SeenTopic>,
    pub readings: u64,
    /// Number of theodolite messages replaced by the topics that the user names.
    stood_in_for: u64,
    without_stamp: [u64; MOST_STATIONS],
    without_any_time: [u64; MOST_STATIONS],
    arrivals: Arrivals,
    inflated: Vec<u8>,
}

impl Stream {
    /// Converts readings; `named` are the topics of stations 1, 2, …, if their messages do not name the station.
    pub fn of_readings(named: Option<PerStation<String>>) -> Self {
        Self {
            named,
            wants_poses: false,
            topics: Vec::new(),
            readings: 0,
            stood_in_for: 0,
            without_stamp: [0; MOST_STATIONS],
            without_any_time: [0; MOST_STATIONS],
            arrivals: Arrivals::default(),
            inflated: Vec::new(),
        }
    }

    /// Converts poses of other systems, and no readings.
    pub fn of_poses() -> Self {
        Self { wants_poses: true, ..Self::of_readings(None) }
    }

    /// Registers a topic; returns `None` if its messages are not wanted.
    pub fn topic(
        &mut self,
        name: &str,
        message_type: &str,
        encoding: Encoding,
    ) -> Option<Subscription> {
        let kind = Kind::of_type(message_type);
        // Positions alone may be the trajectory of a prism or an antenna.
        let kind = kind.filter(|kind| match self.wants_poses {
            true => kind.is_pose() || kind.is_position(),
            false => !kind.is_pose(),
        });
        let known = self.topics.iter().position(|t| t.name == name && t.kind == kind);
        if known.is_none() && self.topics.len() >= MOST_TOPICS {
            return None;
        }
        let topic = known.unwrap_or_else(|| {
            let named = self.named.as_ref();
            let station = named.and_then(|named| named.iter().position(|own| own == name));
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

    /// Name of a topic.
    pub fn name(&self, subscription: Subscription) -> &str {
        &self.topics[subscription.topic].name
    }

    /// Converts a message, recorded at `recorded_s` (s), the `place`-th of all.
    ///
    /// # Errors
    /// The fault of a malformed message, in words that follow the topic's name.
    pub fn message(
        &mut self,
        subscription: Subscription,
        recorded_s: f64,
        place: usize,
        data: &[u8],
        into: &mut Recording,
    ) -> Result<Heard, String> {
        let Subscription { kind, encoding, topic } = subscription;
        self.topics[topic].messages += 1;
        let mut inflated = std::mem::take(&mut self.inflated);
        let message = if data.starts_with(&ZSTD_MAGIC) {
            match inflate::message(data, LARGEST_MESSAGE_BYTES, &mut inflated) {
                Ok(()) => Ok(inflated.as_slice()),
                Err(error) => Err(format!("cannot be decompressed ({error})")),
            }
        } else {
            Ok(data)
        };
        let decoded = message.and_then(|message| {
            let decoded = match encoding {
                Encoding::Json => json_messages::decode(kind, message),
                Encoding::Ros1 | Encoding::Cdr => decode(kind, encoding, message),
            };
            decoded.map_err(|error| format!("is malformed: {error}"))
        });
        self.inflated = inflated;
        Ok(match decoded? {
            Message::Coords(_) if self.named.is_some() => {
                self.stood_in_for += 1;
                Heard::NotTaken
            }
            Message::Coords(coords) => {
                let record = self.coords(&coords, recorded_s, place, into);
                into.push(&record);
                Heard::Record(record)
            }
            Message::Correction(told) => {
                let time_s = told.stamp_s.unwrap_or(recorded_s);
                let correction = TimeCorrection { time_s, offset_s: told.offset_s };
                let number = i64::from(told.station);
                into.push_correction(number, correction);
                Heard::Correction { station: into.station_of(number), correction }
            }
            Message::Point(point) => match self.topics[topic].station {
                Some(station) => {
                    let record = self.point(station, &point, recorded_s, place);
                    into.ranges_include_prism_constant = true;
                    into.push(&record);
                    Heard::Record(record)
                }
                None if self.wants_poses => Heard::Pose {
                    topic,
                    pose: StampedPose {
                        stamp_s: point.stamp_s,
                        position_m: point.position_m,
                        orientation: [0.0; 4],
                        covariance: None,
                        frames: None,
                    },
                },
                None => Heard::NotTaken,
            },
            Message::Pose(pose) => Heard::Pose { topic, pose },
            Message::Transforms(transforms) => Heard::Transforms(transforms),
            Message::Fix(fix) => Heard::Fix { topic, fix },
        })
    }

    fn coords(
        &mut self,
        coords: &Coords,
        recorded_s: f64,
        place: usize,
        into: &Recording,
    ) -> RawRecord {
        let number = i64::from(coords.station);
        let station = into.station_of(number);
        let count = |counts: &mut [u64; MOST_STATIONS]| {
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
        RawRecord {
            station: number,
            status: i64::from(coords.status),
            place,
            own_clock_s,
            measurement: Measurement {
                time_s,
                azimuth_rad: coords.azimuth_rad,
                zenith_rad: coords.zenith_rad,
                range_m: coords.range_m,
            },
        }
    }

    fn point(&mut self, station: usize, point: &Point, recorded_s: f64, place: usize) -> RawRecord {
        if point.stamp_s.is_none() {
            self.without_any_time[station] += 1;
        }
        let polar = Polar::from_cartesian(Vector3::from(point.position_m));
        self.readings += 1;
        RawRecord {
            station: station as i64 + 1,
            status: 0,
            place,
            own_clock_s: None,
            measurement: Measurement {
                time_s: point.stamp_s.unwrap_or(recorded_s),
                range_m: polar.range_m,
                azimuth_rad: polar.azimuth_rad,
                zenith_rad: polar.zenith_rad,
            },
        }
    }

    /// Returns findings about the clock, the topics, and unread messages.
    pub fn findings(&self) -> Vec<Finding> {
        let mut findings = Vec::new();
        for (station, count) in self.without_stamp.into_iter().enumerate().filter(|(_, n)| *n > 0) {
            findings.push(readings_without_stamp(station, count as usize));
        }
        let without_any = self.without_any_time.into_iter().enumerate();
        for (station, count) in without_any.filter(|(_, n)| *n > 0) {
            findings.push(readings_without_time(station, count as usize));
        }
        findings.extend(self.arrivals.finding());
        let unread = self.positions_of_no_station();
        if !unread.is_empty() {
            findings.push(positions_not_read(&list(&unread)));
        }
        if let Some(named) = &self.named {
            findings.push(positions_in_instrument_frames(named.as_slice()));
            let positions: Vec<_> = self.positions().collect();
            for (station, name) in named.iter().enumerate() {
                if !positions.iter().any(|t| t.station == Some(station) && t.messages > 0) {
                    findings.push(topic_without_positions(station, name, &list(&positions)));
                }
            }
        }
        if self.stood_in_for > 0 {
            findings.push(theodolite_messages_not_read(self.stood_in_for as usize));
        }
        findings
    }

    fn positions(&self) -> impl Iterator<Item = &SeenTopic> {
        self.topics.iter().filter(|t| t.kind.is_some_and(Kind::is_position))
    }

    /// Returns the topics with positions of an unknown station.
    pub fn positions_of_no_station(&self) -> Vec<&SeenTopic> {
        self.positions().filter(|t| t.station.is_none() && t.messages > 0).collect()
    }
}

fn list(topics: &[&SeenTopic]) -> String {
    let each =
        topics.iter().map(|t| format!("{} ({}, {} messages)", t.name, t.message_type, t.messages));
    each.collect::<Vec<_>>().join(", ")
}
