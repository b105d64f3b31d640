//! ROS 1 bags, version 2.0 (wiki.ros.org/Bags/Format/2.0): plain, bz2 and lz4, with an index, without one, cut off or damaged.
//!
//! A record is a header of `name=value` fields and a block of data, each after its length. The index is not needed: records are read
//! from the first to the last. Records of an uncompressed chunk are read as if they were in the file itself, records of a compressed
//! chunk from its decoder. After a malformed record, the next plausible one is searched. Recordings that were interrupted (`.active`,
//! no index) or cut short are thus read as far as possible. The index is read first, but only for connections of chunks that have
//! lost their own.
//!
//! The crate `rosbag` (0.6) is unsuitable: it needs a complete index, indexes past the end of a damaged header, and inflates a
//! chunk to any size that it claims.

use std::collections::HashMap;
use std::io::Read;

use super::container::{At, Bytes, Holder, JUDGED_BYTES, Positioned, Stop, read_up_to, salvage};
use super::inflate::{Budget, decoder};
use super::intake::{Intake, LARGEST_MESSAGE_BYTES, Subscription};
use super::wire::Encoding;
use crate::error::OpenError;

pub const MAGIC: &[u8] = b"#ROSBAG V2.0\n";
/// Limit for headers, which contain a topic and little else.
const LARGEST_HEADER_BYTES: u32 = 1 << 16;
/// Limit for connections; the definition of a message is text.
const LARGEST_CONNECTION_BYTES: u32 = 1 << 20;

mod op {
    pub const MESSAGE: u8 = 2;
    pub const BAG_HEADER: u8 = 3;
    pub const INDEX: u8 = 4;
    pub const CHUNK: u8 = 5;
    pub const CHUNK_INFO: u8 = 6;
    pub const CONNECTION: u8 = 7;
}

/// Reads all messages of the bag.
pub fn read(
    mut file: Positioned,
    budget: &Budget,
    intake: &mut Intake<'_>,
) -> Result<(), OpenError> {
    let mut bytes = Vec::new();
    if !read_up_to(&mut file, MAGIC.len() as u64, &mut bytes).unwrap_or(false) || bytes != MAGIC {
        return Err(OpenError::file(
            intake.file(),
            "a ROS 1 bag of another version than 2.0, or cut off within its first line",
            "convert it to version 2.0 with `rosbag fix`",
        ));
    }
    let first = file.at();
    let mut bag = Bag { intake, subscriptions: HashMap::new(), unconnected: 0, bytes };
    let index = bag.read_index(&mut file);
    salvage(&mut file, first, looks_like_record, &mut bag, |bag, file| bag.walk(file, budget))?;
    match index {
        Some((what, true)) => bag.intake.lost(0, what),
        Some((what, false)) => bag.intake.note(&what),
        None => {}
    }
    if bag.unconnected > 0 {
        let lost = format!("{} messages of undescribed connections", bag.unconnected);
        bag.intake.lost(0, lost);
    }
    Ok(())
}

/// State of reading a bag.
struct Bag<'i, 'a> {
    intake: &'i mut Intake<'a>,
    /// Subscriptions by id of the connection; `None` for connections that are not wanted.
    subscriptions: HashMap<u32, Option<Subscription>>,
    /// Number of messages with an unknown connection.
    unconnected: u64,
    /// Buffer, reused.
    bytes: Vec<u8>,
}

impl<'a> Holder<'a> for Bag<'_, 'a> {
    fn intake(&mut self) -> &mut Intake<'a> {
        self.intake
    }
}

/// Fields of a record's header that are needed.
#[derive(Debug, Default)]
struct Header {
    op: u8,
    connection: Option<u32>,
    time_s: Option<f64>,
    compression: String,
    topic: Option<String>,
    index_at: Option<u64>,
}

impl Bag<'_, '_> {
    /// Reads the connections of the index; returns the fault of a bad index, and true if it means a loss.
    fn read_index(&mut self, file: &mut Positioned) -> Option<(String, bool)> {
        // Reading the records reports this damage again.
        let Ok(Some((Header { op: op::BAG_HEADER, index_at: Some(index_at), .. }, _))) =
            self.header(file)
        else {
            return None;
        };
        let length = file.length();
        if index_at == 0 {
            let what = "no index: the recording was interrupted; the last messages may be missing";
            Some((what.to_owned(), true))
        } else if index_at > length {
            Some((
                format!("cut off: the index was at byte {index_at}, but the file ends at {length}"),
                true,
            ))
        } else if file.seek_to(index_at).is_err() || self.walk_index(file).is_err() {
            Some(("the index is damaged; every record was read without it".to_owned(), false))
        } else {
            None
        }
    }

    fn walk_index(&mut self, file: &mut Positioned) -> Result<(), Stop> {
        while let Some((header, length)) = self.header(file)? {
            match header.op {
                op::CONNECTION => self.connection(&header, file, length)?,
                op::CHUNK_INFO => pass_over(file, length)?,
                other => {
                    return Err(Stop::Damaged(format!("a record of kind {other} in the index")));
                }
            }
        }
        Ok(())
    }

    /// Reads one record after the other from the current position.
    fn walk(&mut self, file: &mut Positioned, budget: &Budget) -> Result<(), At<Stop>> {
        loop {
            let start = file.at();
            let at = |stop: Stop| At { start, stop };
            self.intake.done(start as f64 / file.length() as f64).map_err(|e| at(e.into()))?;
            let Some((header, length)) = self.header(file).map_err(at)? else { return Ok(()) };
            if header.op != op::CHUNK {
                self.record(&header, file, length).map_err(at)?;
            } else if header.compression != "none" {
                let walked = self.compressed_chunk(&header, file, length, budget);
                if budget.is_spent() {
                    return Err(at(budget.refusal(self.intake.file()).into()));
                }
                walked.map_err(at)?;
            }
            // The records of an uncompressed chunk follow its header.
        }
    }

    fn compressed_chunk(
        &mut self,
        header: &Header,
        file: &mut Positioned,
        length: u32,
        budget: &Budget,
    ) -> Result<(), Stop> {
        let end = file.at() + u64::from(length);
        let Some(decoder) = decoder(&header.compression, file.by_ref().take(length.into())) else {
            return Err(Stop::Damaged(format!("compression `{}`", header.compression)));
        };
        let mut records: Box<dyn Read + '_> = Box::new(budget.watch(decoder?));
        while let Some((header, length)) = self.header(&mut records)? {
            self.record(&header, &mut records, length)?;
        }
        drop(records);
        if end > file.length() {
            return Err(Stop::cut());
        }
        Ok(file.seek_to(end)?)
    }

    /// Reads any record but a chunk.
    fn record<R: Bytes>(&mut self, header: &Header, from: &mut R, length: u32) -> Result<(), Stop> {
        match header.op {
            op::MESSAGE => self.message(header, from, length),
            op::CONNECTION => self.connection(header, from, length),
            op::BAG_HEADER | op::INDEX | op::CHUNK_INFO => pass_over(from, length),
            other => Err(Stop::Damaged(format!("a record of unknown kind {other}"))),
        }
    }

    fn message<R: Bytes>(
        &mut self,
        header: &Header,
        from: &mut R,
        length: u32,
    ) -> Result<(), Stop> {
        let (Some(connection), Some(time_s)) = (header.connection, header.time_s) else {
            return Err(Stop::Damaged("a message without connection and time".to_owned()));
        };
        match self.subscriptions.get(&connection) {
            Some(Some(subscription)) if length as usize > LARGEST_MESSAGE_BYTES => {
                self.intake.overlong_message(*subscription, length.into());
                pass_over(from, length)
            }
            Some(Some(subscription)) => {
                let subscription = *subscription;
                if !read_up_to(from, length.into(), &mut self.bytes)? {
                    return Err(Stop::cut());
                }
                Ok(self.intake.message(subscription, time_s, &self.bytes)?)
            }
            known => {
                self.unconnected += u64::from(known.is_none());
                pass_over(from, length)
            }
        }
    }

    fn connection<R: Bytes>(
        &mut self,
        header: &Header,
        from: &mut R,
        length: u32,
    ) -> Result<(), Stop> {
        let (Some(number), Some(topic)) = (header.connection, &header.topic) else {
            return Err(Stop::Damaged("a connection without number and topic".to_owned()));
        };
        if length > LARGEST_CONNECTION_BYTES {
            return pass_over(from, length);
        }
        if !read_up_to(from, length.into(), &mut self.bytes)? {
            return Err(Stop::cut());
        }
        let message_type = fields(&self.bytes).flatten().find(|(name, _)| *name == b"type");
        if let Some((_, message_type)) = message_type {
            let message_type = String::from_utf8_lossy(message_type);
            let subscription = self.intake.topic(topic, &message_type, Encoding::Ros1);
            self.subscriptions.insert(number, subscription);
        }
        Ok(())
    }

    /// Reads the next record's header, and the length of its data; `None` at the end.
    fn header<R: Bytes>(&mut self, from: &mut R) -> Result<Option<(Header, u32)>, Stop> {
        if !read_up_to(from, 4, &mut self.bytes)? {
            return if self.bytes.is_empty() { Ok(None) } else { Err(Stop::cut()) };
        }
        let length = u32_of(&self.bytes).unwrap_or_default();
        if length > LARGEST_HEADER_BYTES {
            return Err(Stop::Damaged(format!("a header of {length} bytes")));
        }
        if !read_up_to(from, u64::from(length) + 4, &mut self.bytes)? {
            return Err(Stop::cut());
        }
        let (header, data_length) = self.bytes.split_at(length as usize);
        let header = parse(header)
            .ok_or_else(|| Stop::Damaged("a header that is no list of fields".to_owned()))?;
        Ok(u32_of(data_length).map(|data_length| (header, data_length)))
    }
}

fn pass_over<R: Bytes>(from: &mut R, length: u32) -> Result<(), Stop> {
    let length = u64::from(length);
    if from.skip(length)? < length { Err(Stop::cut()) } else { Ok(()) }
}

fn u32_of(bytes: &[u8]) -> Option<u32> {
    bytes.first_chunk().map(|four| u32::from_le_bytes(*four))
}

/// Iterates over names and values; a malformed field is `None`, and the last.
fn fields(mut bytes: &[u8]) -> impl Iterator<Item = Option<(&[u8], &[u8])>> {
    std::iter::from_fn(move || {
        if bytes.is_empty() {
            return None;
        }
        let field = (|| {
            let (length, rest) = bytes.split_first_chunk::<4>()?;
            let (field, rest) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
            let equals = field.iter().position(|byte| *byte == b'=')?;
            bytes = rest;
            Some((&field[..equals], &field[equals + 1..]))
        })();
        if field.is_none() {
            bytes = &[];
        }
        Some(field)
    })
}

/// Parses a header; `None` if it is malformed.
fn parse(bytes: &[u8]) -> Option<Header> {
    let mut header = Header::default();
    for field in fields(bytes) {
        let (name, value) = field?;
        match name {
            b"op" => header.op = *value.first()?,
            b"conn" => header.connection = Some(u32_of(value)?),
            b"time" => {
                let nanoseconds = u32_of(value.get(4..)?)?;
                header.time_s = Some(f64::from(u32_of(value)?) + f64::from(nanoseconds) * 1e-9);
            }
            b"compression" => header.compression = String::from_utf8_lossy(value).into_owned(),
            b"topic" => header.topic = Some(String::from_utf8_lossy(value).into_owned()),
            b"index_pos" => {
                header.index_at = Some(u64::from_le_bytes(*value.first_chunk()?));
            }
            _ => {}
        }
    }
    (header.op != 0).then_some(header)
}

/// Returns true if these bytes can begin a record.
fn looks_like_record(bytes: &[u8]) -> bool {
    let Some(length) = u32_of(bytes).map(|length| length as usize) else { return false };
    let Some(first_field) = bytes.get(4..).and_then(u32_of) else { return false };
    // A cheap test first, because every position is tested.
    if !(8..JUDGED_BYTES - 8).contains(&length) || first_field as usize + 4 > length {
        return false;
    }
    let header = bytes.get(4..4 + length).filter(|_| bytes.len() >= length + 8).and_then(parse);
    header.is_some_and(|header| match header.op {
        op::MESSAGE => header.connection.is_some() && header.time_s.is_some(),
        op::CONNECTION => header.connection.is_some() && header.topic.is_some(),
        op::INDEX => header.connection.is_some(),
        op::CHUNK => !header.compression.is_empty(),
        op::BAG_HEADER | op::CHUNK_INFO => true,
        _ => false,
    })
}
