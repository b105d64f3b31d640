//! What comes in, as MCAP, while it comes in: original channels, definitions and payloads, for our own reader and for others.
//!
//! A chunk is written as a whole when it is flushed, so that a file that nobody ended holds all up to the last flush.

use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions, Writer};

use super::event::{Channel, Sent};
use resect_io::atomic::WriteError;

/// A chunk that grows to so many bytes is written before it is flushed.
const CHUNK_BYTES: u64 = 1 << 18;
/// More channels than a robot has are not recorded.
const MOST_CHANNELS: usize = 1000;

/// A recording that is being written.
pub struct Recorder {
    path: PathBuf,
    writer: Writer<BufWriter<File>>,
    /// Channels of the file by those of the source.
    channels: HashMap<u64, u16>,
    messages: u64,
}

/// What was recorded so far.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recorded {
    pub path: PathBuf,
    pub messages: u64,
}

/// Why a recording cannot be begun, or goes no further.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    #[error("{0}: it is there already, and is not written over; name another file")]
    Exists(String),
    #[error(transparent)]
    Write(WriteError),
    #[error("{0}: cannot be recorded ({1}); look at the disk, and name another file")]
    Mcap(String, McapError),
}

impl Recorder {
    /// Begins a file that is not there yet.
    pub fn create(path: &Path) -> Result<Self, RecordError> {
        let file = File::create_new(path).map_err(|error| match error.kind() {
            std::io::ErrorKind::AlreadyExists => RecordError::Exists(path.display().to_string()),
            _ => RecordError::Write(WriteError::of_file(path, error)),
        })?;
        let options = WriteOptions::new()
            .compression(None)
            .profile("ros2")
            .library("resect")
            .chunk_size(Some(CHUNK_BYTES))
            // What is flushed is whole: nothing of it is put right later.
            .disable_seeking(true);
        let writer = options
            .create(BufWriter::new(file))
            .map_err(|error| RecordError::Mcap(path.display().to_string(), error))?;
        let mut recorder =
            Self { path: path.to_owned(), writer, channels: HashMap::new(), messages: 0 };
        recorder.flush()?;
        Ok(recorder)
    }

    /// A source that connects again numbers its channels anew.
    pub fn forget_channels(&mut self) {
        self.channels.clear();
    }

    /// Describes a channel whose messages may follow.
    pub fn channel(&mut self, channel: &Channel) -> Result<(), RecordError> {
        if self.channels.len() >= MOST_CHANNELS {
            return Ok(());
        }
        let Channel { topic, message_type, encoding, schema, schema_encoding, .. } = channel;
        // The crate gives the same channel and definition the same number again.
        let added = self.writer.add_schema(message_type, schema_encoding, schema);
        let number = added
            .and_then(|schema| self.writer.add_channel(schema, topic, encoding, &BTreeMap::new()));
        let number = number.map_err(|error| self.failed(error))?;
        self.channels.insert(channel.id, number);
        Ok(())
    }

    pub fn message(&mut self, sent: &Sent) -> Result<(), RecordError> {
        let Some(channel_id) = self.channels.get(&sent.channel).copied() else { return Ok(()) };
        let sequence = self.messages as u32;
        let header = MessageHeader {
            channel_id,
            sequence,
            log_time: sent.sent_ns,
            publish_time: sent.sent_ns,
        };
        let written = self.writer.write_to_known_channel(&header, &sent.payload);
        written.map_err(|error| self.failed(error))?;
        self.messages += 1;
        Ok(())
    }

    /// Makes sure that what came so far outlives this process.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        self.writer.flush().map_err(|error| self.failed(error))
    }

    pub fn recorded(&self) -> Recorded {
        Recorded { path: self.path.clone(), messages: self.messages }
    }

    /// Ends the file as its format asks, and makes sure that the disk has it.
    pub fn finish(mut self) -> Result<Recorded, RecordError> {
        self.writer.finish().map_err(|error| self.failed(error))?;
        let recorded = self.recorded();
        let path = self.path.clone();
        let file = self.writer.into_inner();
        let file = file
            .into_inner()
            .map_err(|error| RecordError::Write(WriteError::of_file(&path, error.into_error())))?;
        file.sync_all().map_err(|error| RecordError::Write(WriteError::of_file(&path, error)))?;
        Ok(recorded)
    }

    fn failed(&self, error: McapError) -> RecordError {
        match error {
            McapError::Io(error) => RecordError::Write(WriteError::of_file(&self.path, error)),
            error => RecordError::Mcap(self.path.display().to_string(), error),
        }
    }
}
