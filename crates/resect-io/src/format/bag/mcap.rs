//! MCAP files (mcap.dev/spec, version 0), plain or with chunks in lz4 or zstd: complete, without a footer, cut off or damaged.
//!
//! A record is one byte of kind, eight bytes of length, and the data. Neither index nor footer is needed: records are read from the
//! first to the last, those of an uncompressed chunk as if they were in the file itself. A chunk with a wrong checksum is skipped.
//! After a malformed record, the search for the next chunk begins. The summary is read first, but only for schemas and channels of
//! chunks that have lost their own.
//!
//! The crate `mcap` (0.26) is unsuitable: its readers give up at the first damage, and its parser allocates the length that a
//! string claims. Only four kinds of record are needed.

use std::collections::HashMap;
use std::io::Read;

use super::container::{At, Bytes, Holder, Positioned, Stop, read_up_to, salvage};
use super::inflate::{Budget, decoder};
use super::intake::{Intake, LARGEST_MESSAGE_BYTES, Subscription};
use super::wire::{Encoding, Malformed, Wire};
use crate::error::OpenError;

pub const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// Limit for schemas and channels; the definition of a message is text.
const LARGEST_RECORD_BYTES: u64 = 1 << 20;
/// Size of a message record before its data: channel, sequence, two times.
const MESSAGE_HEAD_BYTES: u64 = 2 + 4 + 8 + 8;
/// Size of a chunk before its records, without the name of the compression.
const CHUNK_HEAD_BYTES: u64 = 8 + 8 + 8 + 4 + 4 + 8;
/// Size of the footer and the closing magic.
const TAIL_BYTES: u64 = 1 + 8 + 20 + 8;

mod op {
    pub const FOOTER: u8 = 2;
    pub const SCHEMA: u8 = 3;
    pub const CHANNEL: u8 = 4;
    pub const MESSAGE: u8 = 5;
    pub const CHUNK: u8 = 6;
    /// First byte of the closing magic, at the position of a record.
    pub const END: u8 = MAGIC_FIRST;
    const MAGIC_FIRST: u8 = 0x89;
}

/// Reads all messages of the file.
pub fn read(
    mut file: Positioned,
    budget: &Budget,
    intake: &mut Intake<'_>,
) -> Result<(), OpenError> {
    let mut recording = McapRecording {
        intake,
        types: HashMap::new(),
        subscriptions: HashMap::new(),
        without_channel: 0,
        ended: false,
        bytes: Vec::new(),
    };
    recording.read_summary(&mut file);
    let first = MAGIC.len() as u64;
    salvage(&mut file, first, looks_like_chunk, &mut recording, |recording, file| {
        recording.walk(file, budget)
    })?;
    if recording.without_channel > 0 {
        let lost = format!("{} messages of undescribed channels", recording.without_channel);
        recording.intake.lost(0, lost);
    }
    if !recording.ended {
        let what = "no footer: the recording was interrupted or the file is cut off; the last messages may be missing";
        recording.intake.lost(0, what);
    }
    Ok(())
}

struct McapRecording<'i, 'a> {
    intake: &'i mut Intake<'a>,
    /// Names of message types by id of the schema.
    types: HashMap<u16, String>,
    /// Subscriptions by id of the channel; `None` for channels that are not wanted.
    subscriptions: HashMap<u16, Option<Subscription>>,
    without_channel: u64,
    /// True after the closing magic.
    ended: bool,
    /// Buffer, reused.
    bytes: Vec<u8>,
}

impl<'a> Holder<'a> for McapRecording<'_, 'a> {
    fn intake(&mut self) -> &mut Intake<'a> {
        self.intake
    }
}

impl From<Malformed> for Stop {
    fn from(_: Malformed) -> Self {
        Self::Damaged("a record that ends too early".to_owned())
    }
}

impl McapRecording<'_, '_> {
    /// Reads the schemas and channels of the summary, if there is one. Reading the records reports any damage again.
    fn read_summary(&mut self, file: &mut Positioned) {
        let tail = file.length().saturating_sub(TAIL_BYTES);
        if file.seek_to(tail).is_err() {
            return;
        }
        let Ok(Some((op::FOOTER, 20))) = self.head(file) else { return };
        let Ok(true) = read_up_to(file, 8, &mut self.bytes) else { return };
        let Some(summary_at) = self.bytes.first_chunk().map(|at| u64::from_le_bytes(*at)) else {
            return;
        };
        if summary_at == 0 || summary_at >= tail || file.seek_to(summary_at).is_err() {
            return;
        }
        while file.at() < tail {
            match self.head(file) {
                Ok(Some((op::MESSAGE | op::CHUNK, _)) | None) | Err(_) => return,
                Ok(Some((kind, length))) => {
                    if self.record(kind, length, file).is_err() {
                        return;
                    }
                }
            }
        }
    }

    /// Reads one record after the other from the current position.
    fn walk(&mut self, file: &mut Positioned, budget: &Budget) -> Result<(), At<Stop>> {
        loop {
            let start = file.at();
            let at = |stop: Stop| At { start, stop };
            self.intake.done(start as f64 / file.length() as f64).map_err(|e| at(e.into()))?;
            if file.left() == MAGIC.len() as u64 {
                let closed = read_up_to(file, MAGIC.len() as u64, &mut self.bytes);
                if closed.is_ok_and(|closed| closed) && self.bytes == MAGIC {
                    self.ended = true;
                    return Ok(());
                }
                file.seek_to(start).map_err(|e| at(e.into()))?;
            }
            match self.head(file).map_err(at)? {
                None => return Ok(()),
                Some((op::CHUNK, length)) => {
                    let walked = self.chunk(length, file, budget);
                    if budget.is_spent() {
                        return Err(at(budget.refusal(self.intake.file()).into()));
                    }
                    walked.map_err(at)?;
                }
                Some((0, _)) => return Err(at(Stop::Damaged("a record of kind 0".to_owned()))),
                Some((kind, length)) => self.record(kind, length, file).map_err(at)?,
            }
        }
    }

    fn chunk(&mut self, length: u64, file: &mut Positioned, budget: &Budget) -> Result<(), Stop> {
        let start = file.at();
        let end = start.saturating_add(length);
        if !read_up_to(file, CHUNK_HEAD_BYTES + 8, &mut self.bytes)? {
            return Err(Stop::cut());
        }
        let head = ChunkHead::parse(&self.bytes)?;
        let records_at = start + head.bytes;
        let whole = end <= file.length();
        if records_at.checked_add(head.compressed_bytes) != Some(end) {
            return Err(Stop::Damaged("a chunk whose lengths contradict each other".to_owned()));
        }
        // A chunk that is cut off is read up to its end; its checksum cannot be tested.
        if whole && head.checksum != 0 {
            file.seek_to(records_at)?;
            if checksum(head.records(file, budget)?)? != head.checksum {
                let why = format!("the chunk at byte {start} is damaged (its checksum is wrong)");
                self.intake.lost(head.compressed_bytes, why);
                return Ok(file.seek_to(end)?);
            }
        }
        file.seek_to(records_at)?;
        if head.compression.is_empty() {
            if !whole {
                let missing = end.saturating_sub(file.length());
                self.intake
                    .lost(0, format!("cut off: {missing} bytes of its last chunk are missing"));
            }
            // The records of an uncompressed chunk follow.
            return Ok(());
        }
        let mut records = head.records(file, budget)?;
        while let Some((kind, length)) = self.head(&mut records)? {
            if kind == 0 || kind == op::CHUNK {
                return Err(Stop::Damaged(format!("a record of kind {kind} in a chunk")));
            }
            self.record(kind, length, &mut records)?;
        }
        drop(records);
        if !whole {
            return Err(Stop::cut());
        }
        Ok(file.seek_to(end)?)
    }

    /// Reads kind and length of the next record; `None` at the end.
    fn head<R: Bytes>(&mut self, from: &mut R) -> Result<Option<(u8, u64)>, Stop> {
        if !read_up_to(from, 9, &mut self.bytes)? {
            return if self.bytes.is_empty() { Ok(None) } else { Err(Stop::cut()) };
        }
        let mut wire = Wire::new(Encoding::Ros1, &self.bytes)?;
        Ok(Some((wire.u8()?, wire.u64()?)))
    }

    /// Reads any record but a chunk. Unknown kinds are skipped, as the specification requires.
    fn record<R: Bytes>(&mut self, kind: u8, length: u64, from: &mut R) -> Result<(), Stop> {
        match kind {
            op::SCHEMA | op::CHANNEL if length <= LARGEST_RECORD_BYTES => {
                if !read_up_to(from, length, &mut self.bytes)? {
                    return Err(Stop::cut());
                }
                let mut wire = Wire::new(Encoding::Ros1, &self.bytes)?;
                let id = wire.u16()?;
                if kind == op::SCHEMA {
                    let name = String::from_utf8_lossy(wire.string()?).into_owned();
                    self.types.insert(id, name);
                } else {
                    let message_type = self.types.get(&wire.u16()?).map_or("", String::as_str);
                    let topic = String::from_utf8_lossy(wire.string()?);
                    let subscription = match wire.string()? {
                        b"cdr" => self.intake.topic(&topic, message_type, Encoding::Cdr),
                        b"ros1" => self.intake.topic(&topic, message_type, Encoding::Ros1),
                        b"json" => self.intake.topic(&topic, message_type, Encoding::Json),
                        other => {
                            // Listed by errors; its messages are not decoded.
                            let other = String::from_utf8_lossy(other);
                            let message_type = format!("{message_type}, encoded as {other}");
                            self.intake.topic(&topic, &message_type, Encoding::Cdr)
                        }
                    };
                    self.subscriptions.insert(id, subscription);
                }
                Ok(())
            }
            op::MESSAGE => self.message(length, from),
            op::END => Err(Stop::Damaged("its closing bytes before its end".to_owned())),
            _ => pass_over(from, length),
        }
    }

    fn message<R: Bytes>(&mut self, length: u64, from: &mut R) -> Result<(), Stop> {
        let data_bytes = length
            .checked_sub(MESSAGE_HEAD_BYTES)
            .ok_or_else(|| Stop::Damaged(format!("a message of {length} bytes")))?;
        if !read_up_to(from, MESSAGE_HEAD_BYTES, &mut self.bytes)? {
            return Err(Stop::cut());
        }
        let mut wire = Wire::new(Encoding::Ros1, &self.bytes)?;
        let (channel, _) = (wire.u16()?, wire.u32()?);
        let recorded_s = wire.u64()? as f64 * 1e-9;
        match self.subscriptions.get(&channel) {
            Some(Some(subscription)) if data_bytes > LARGEST_MESSAGE_BYTES as u64 => {
                self.intake.overlong_message(*subscription, data_bytes);
                pass_over(from, data_bytes)
            }
            Some(Some(subscription)) => {
                let subscription = *subscription;
                if !read_up_to(from, data_bytes, &mut self.bytes)? {
                    return Err(Stop::cut());
                }
                Ok(self.intake.message(subscription, recorded_s, &self.bytes)?)
            }
            known => {
                self.without_channel += u64::from(known.is_none());
                pass_over(from, data_bytes)
            }
        }
    }
}

/// Header of a chunk.
struct ChunkHead {
    checksum: u32,
    compression: String,
    compressed_bytes: u64,
    /// Size of the header (bytes).
    bytes: u64,
}

impl ChunkHead {
    fn parse(bytes: &[u8]) -> Result<Self, Stop> {
        let mut wire = Wire::new(Encoding::Ros1, bytes)?;
        let (_start, _end, _uncompressed_bytes) = (wire.u64()?, wire.u64()?, wire.u64()?);
        let checksum = wire.u32()?;
        let compression = String::from_utf8_lossy(wire.string()?).into_owned();
        let compressed_bytes = wire.u64()?;
        let bytes = CHUNK_HEAD_BYTES + compression.len() as u64;
        Ok(Self { checksum, compression, compressed_bytes, bytes })
    }

    /// Returns a reader of the chunk's inflated records; `file` is at their beginning.
    fn records<'r>(
        &self,
        file: &'r mut Positioned,
        budget: &'r Budget,
    ) -> Result<Box<dyn Read + 'r>, Stop> {
        let compressed = file.by_ref().take(self.compressed_bytes);
        if self.compression.is_empty() {
            return Ok(Box::new(compressed));
        }
        match decoder(&self.compression, compressed) {
            Some(decoder) => Ok(Box::new(budget.watch(decoder?))),
            None => Err(Stop::Damaged(format!("compression `{}`", self.compression))),
        }
    }
}

fn pass_over<R: Bytes>(from: &mut R, length: u64) -> Result<(), Stop> {
    if from.skip(length)? < length { Err(Stop::cut()) } else { Ok(()) }
}

fn checksum(mut bytes: Box<dyn Read + '_>) -> std::io::Result<u32> {
    let mut hasher = crc32fast::Hasher::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        match bytes.read(&mut buffer)? {
            0 => return Ok(hasher.finalize()),
            read => hasher.update(&buffer[..read]),
        }
    }
}

/// Returns true if these bytes can begin a chunk: its lengths must be consistent.
fn looks_like_chunk(bytes: &[u8]) -> bool {
    if bytes.first() != Some(&op::CHUNK) {
        return false;
    }
    let Some((length, body)) = bytes[1..].split_first_chunk::<8>() else { return false };
    ChunkHead::parse(body).is_ok_and(|head| {
        ["", "lz4", "zstd"].contains(&head.compression.as_str())
            && head.bytes.checked_add(head.compressed_bytes) == Some(u64::from_le_bytes(*length))
    })
}
