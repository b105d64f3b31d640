//! Findings about bags and streams of messages.

use crate::findings::kinds;
use resect_core::deployment::{Finding, Subject, Unit};

/// Losses of a bag.
pub struct Losses<'a> {
    /// The first loss with its place.
    pub first: &'a str,
    pub count: usize,
    pub bytes: u64,
    /// Number of messages that could be read.
    pub messages: usize,
}

pub fn bag_damaged(file: &str, losses: &Losses<'_>) -> Finding {
    let Losses { first, count, bytes, messages } = *losses;
    let more = match count {
        0 | 1 => String::new(),
        2 => ", and one more place".to_owned(),
        count => format!(", and {} more places", count - 1),
    };
    let lost = match bytes {
        0 => String::new(),
        bytes => format!("; {bytes} bytes could not be read"),
    };
    Finding::new(
        kinds::BAG_DAMAGED,
        format!("{first}{more}{lost}; {messages} messages could be read"),
    )
    .about(Subject::File(file.to_owned()))
    .within(file)
    .count("places", count)
    .quantity("bytes", bytes as f64, Unit::Count)
    .count("messages", messages)
}

pub fn bag_messages_malformed(file: &str, count: usize, first: &str) -> Finding {
    let message = format!("{count} messages left out; the first: {first}");
    Finding::new(kinds::BAG_MESSAGES_MALFORMED, message)
        .about(Subject::File(file.to_owned()))
        .within(file)
        .count("messages", count)
}

/// `remark` describes the state in which the interrupted recording left the file.
pub fn bag_incomplete(file: &str, remark: &str) -> Finding {
    Finding::new(kinds::BAG_INCOMPLETE, remark).about(Subject::File(file.to_owned())).within(file)
}

/// `others` contain the same readings as `file`.
pub fn copies_left_out<'a>(file: &str, others: impl Iterator<Item = &'a str>) -> Finding {
    let others: Vec<&str> = others.collect();
    let message = format!("{file} is read; the same readings are in {}", others.join(", "));
    Finding::new(kinds::COPIES_LEFT_OUT, message)
        .about(Subject::File(file.to_owned()))
        .count("files", others.len())
}

pub fn bag_splits_unread(file: &str, others: &[&str]) -> Finding {
    Finding::new(
        kinds::BAG_SPLITS_UNREAD,
        format!(
            "{file} is one of several bags of a recording; not read: {}. Open the folder, or list all bags in `tracks` of \
             deployment.toml",
            others.join(", ")
        ),
    )
    .about(Subject::File(file.to_owned()))
    .count("files", others.len())
}

pub fn bags_joined(names: &[&str]) -> Finding {
    let message = format!("{} bags are read as one drive: {}", names.len(), names.join(", "));
    Finding::new(kinds::BAGS_JOINED, message).count("files", names.len())
}

pub fn bag_missing(names: &[&str], missing: u64) -> Finding {
    Finding::new(
        kinds::BAG_MISSING,
        format!(
            "{} bags are read as one drive: {}; bag number {missing} is missing",
            names.len(),
            names.join(", ")
        ),
    )
    .count("files", names.len())
    .quantity("missing_number", missing as f64, Unit::Count)
}

pub fn readings_without_stamp(station: usize, count: usize) -> Finding {
    Finding::new(
        kinds::READINGS_WITHOUT_STAMP,
        format!(
            "station {}: {count} readings have no synchronised time (header.stamp is zero); theodolite_time is used, \
             the station's own unsynchronised clock",
            station + 1
        ),
    )
    .about(Subject::Station(station))
    .count("readings", count)
}

pub fn readings_without_time(station: usize, count: usize) -> Finding {
    Finding::new(
        kinds::READINGS_WITHOUT_TIME,
        format!(
            "station {}: {count} readings have no stamp; their time of arrival at the recorder is used, with an \
             unknown and varying latency",
            station + 1
        ),
    )
    .about(Subject::Station(station))
    .count("readings", count)
}

pub fn positions_not_read(topics: &str) -> Finding {
    Finding::new(kinds::POSITIONS_NOT_READ, format!("positions not read: {topics}"))
}

pub fn positions_in_instrument_frames(topics: &[String]) -> Finding {
    Finding::new(
        kinds::POSITIONS_IN_INSTRUMENT_FRAMES,
        format!(
            "positions of {} are read in each instrument's own frame and include the prism constant; if an instrument \
             was set up in site coordinates, the range and angle rates are not those that it measured",
            topics.join(", ")
        ),
    )
}

pub fn topic_without_positions(station: usize, topic: &str, there: &str) -> Finding {
    Finding::new(
        kinds::TOPIC_WITHOUT_POSITIONS,
        format!(
            "station {}: no position on its topic `{topic}`; topics with positions: {there}",
            station + 1
        ),
    )
    .about(Subject::Station(station))
}

pub fn theodolite_messages_not_read(count: usize) -> Finding {
    Finding::new(
        kinds::THEODOLITE_MESSAGES_NOT_READ,
        format!("{count} theodolite messages are not read: `topics` names other topics"),
    )
    .count("messages", count)
}

pub(super) fn examples() -> Vec<Finding> {
    let losses = Losses { first: "cut off, after message 9", count: 2, bytes: 80, messages: 900 };
    vec![
        bag_damaged("drive.bag", &losses),
        bag_messages_malformed("drive.bag", 4, "message 7, of /theodolite, has 3 bytes"),
        bag_incomplete("drive.bag", "no index, read record by record"),
        bag_splits_unread("drive_0.bag", &["drive_1.bag"]),
        copies_left_out("drive.bag", ["drive.orig.bag"].into_iter()),
        bags_joined(&["drive_0.bag", "drive_1.bag"]),
        bag_missing(&["drive_0.bag", "drive_2.bag"], 1),
        readings_without_stamp(1, 30),
        readings_without_time(1, 30),
        positions_not_read("/rts/position (geometry_msgs/PointStamped, 90 messages)"),
        positions_in_instrument_frames(&["/rts1".to_owned(), "/rts2".to_owned()]),
        topic_without_positions(2, "/rts3", "/rts1 (geometry_msgs/PointStamped, 90 messages)"),
        theodolite_messages_not_read(500),
    ]
}
