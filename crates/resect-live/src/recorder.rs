//! Recording of all events as MCAP while they arrive: original channels, definitions and payloads, for this reader and for others.
//!
//! Each flush writes a complete chunk, so a file without an end has everything up to the last flush.

use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions, Writer};

use super::event::{Channel, Sent};
use resect_io::atomic::WriteError;

/// Size at which a chunk is written before the next flush (bytes).
const CHUNK_BYTES: u64 = 1 << 18;
/// Largest number of channels; further ones are not recorded.
const MOST_CHANNELS: usize = 1000;

/// A recording in progress.
pub struct Recorder {
    path: PathBuf,
    writer: Writer<BufWriter<File>>,
    /// Channel numbers in the file, by those of the source.
    channels: HashMap<u64, u16>,
    messages: u64,
}

/// File and number of messages of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recorded {
    pub path: PathBuf,
    pub messages: u64,
}

/// Reason why a recording cannot begin or continue.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    #[error("{0}: already exists and is not overwritten; choose another file")]
    Exists(String),
    #[error(transparent)]
    Write(WriteError),
    #[error("{0}: cannot be recorded ({1}); check the disk, and choose another file")]
    Mcap(String, McapError),
}

impl Recorder {
    /// Creates a new file; an error if it exists.
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
            // Flushed data is final, so nothing seeks back to correct it.
            .disable_seeking(true);
        let writer = options
            .create(BufWriter::new(file))
            .map_err(|error| RecordError::Mcap(path.display().to_string(), error))?;
        let mut recorder =
            Self { path: path.to_owned(), writer, channels: HashMap::new(), messages: 0 };
        recorder.flush()?;
        Ok(recorder)
    }

    /// Forgets all channels, because a source that reconnects numbers them anew.
    pub fn forget_channels(&mut self) {
        self.channels.clear();
    }

    /// Adds a channel, of which messages may follow.
    pub fn channel(&mut self, channel: &Channel) -> Result<(), RecordError> {
        if self.channels.len() >= MOST_CHANNELS {
            return Ok(());
        }
        let Channel { topic, message_type, encoding, schema, schema_encoding, .. } = channel;
        // The crate returns the same number for the same channel and definition.
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

    /// Flushes the messages so far, so that they outlive this process.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        self.writer.flush().map_err(|error| self.failed(error))
    }

    pub fn recorded(&self) -> Recorded {
        Recorded { path: self.path.clone(), messages: self.messages }
    }

    /// Finishes the file as its format requires, and syncs it to the disk.
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
