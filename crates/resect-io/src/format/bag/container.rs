//! Reading of damaged containers of records: bytes with a position, and the search for the next plausible record.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};

use super::intake::Intake;
use crate::error::OpenError;

/// Number of bytes that are examined at each position in the search for a record.
pub const JUDGED_BYTES: usize = 4096;
const WINDOW_BYTES: usize = 1 << 18;

/// Bytes read in sequence, some of them skipped.
pub trait Bytes: Read + Sized {
    /// Skips bytes; returns fewer than requested at the end.
    fn skip(&mut self, count: u64) -> io::Result<u64> {
        io::copy(&mut self.by_ref().take(count), &mut io::sink())
    }
}

/// A file with its position.
pub struct Positioned {
    file: BufReader<File>,
    at: u64,
    length: u64,
}

impl Positioned {
    pub fn new(file: File) -> io::Result<Self> {
        let length = file.metadata()?.len();
        Ok(Self { file: BufReader::with_capacity(1 << 16, file), at: 0, length })
    }

    pub fn at(&self) -> u64 {
        self.at
    }

    pub fn length(&self) -> u64 {
        self.length
    }

    pub fn left(&self) -> u64 {
        self.length.saturating_sub(self.at)
    }

    pub fn seek_to(&mut self, at: u64) -> io::Result<()> {
        // Within the buffer, a relative seek reads nothing.
        match i64::try_from(i128::from(at) - i128::from(self.at)) {
            Ok(by) => self.file.seek_relative(by)?,
            Err(_) => return Err(io::ErrorKind::InvalidInput.into()),
        }
        self.at = at;
        Ok(())
    }

    /// Seeks the first position from `from` on that `is_record` accepts; it receives at most [`JUDGED_BYTES`] of each position.
    pub fn find(
        &mut self,
        from: u64,
        mut step: impl FnMut(u64) -> io::Result<()>,
        is_record: impl Fn(&[u8]) -> bool,
    ) -> io::Result<bool> {
        let mut window = Vec::with_capacity(WINDOW_BYTES + JUDGED_BYTES);
        let mut start = from;
        while start < self.length {
            step(start)?;
            window.clear();
            self.file.seek(SeekFrom::Start(start))?;
            let wanted = (WINDOW_BYTES + JUDGED_BYTES) as u64;
            self.file.by_ref().take(wanted).read_to_end(&mut window)?;
            let judged = window.len().min(WINDOW_BYTES);
            let found =
                (0..judged).find(|at| is_record(&window[*at..window.len().min(at + JUDGED_BYTES)]));
            if let Some(found) = found {
                self.at = start + found as u64;
                self.file.seek(SeekFrom::Start(self.at))?;
                return Ok(true);
            }
            if judged == 0 {
                break;
            }
            start += judged as u64;
        }
        self.at = self.length;
        self.file.seek(SeekFrom::Start(self.at))?;
        Ok(false)
    }
}

impl Read for Positioned {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.file.read(buffer)?;
        self.at += read as u64;
        Ok(read)
    }
}

impl Bytes for Positioned {
    fn skip(&mut self, count: u64) -> io::Result<u64> {
        let count = count.min(self.left());
        self.seek_to(self.at + count)?;
        Ok(count)
    }
}

impl Bytes for Box<dyn Read + '_> {}

/// Reads `count` bytes, or all that are left; returns true if complete. Never allocates a claimed length before the bytes are read.
pub fn read_up_to(reader: &mut impl Read, count: u64, into: &mut Vec<u8>) -> io::Result<bool> {
    into.clear();
    reader.take(count).read_to_end(into)?;
    Ok(into.len() as u64 == count)
}

/// Reason why reading stopped before the last record.
pub enum Stop {
    /// The bag cannot be read.
    Refused(OpenError),
    /// A malformed record; later ones may be readable.
    Damaged(String),
}

impl Stop {
    pub fn cut() -> Self {
        Self::Damaged("cut off".to_owned())
    }
}

impl From<io::Error> for Stop {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::UnexpectedEof => Self::cut(),
            _ => Self::Damaged(error.to_string()),
        }
    }
}

impl From<OpenError> for Stop {
    fn from(error: OpenError) -> Self {
        Self::Refused(error)
    }
}

/// A reason to stop, with the position of the record in the file.
pub struct At<T> {
    pub start: u64,
    pub stop: T,
}

/// A reader of a container, with its intake.
pub trait Holder<'a> {
    fn intake(&mut self) -> &mut Intake<'a>;
}

/// Reads a file from `first` on. After every malformed record it continues at the next plausible one, and counts the bytes between
/// as lost.
pub fn salvage<'a, H: Holder<'a>>(
    file: &mut Positioned,
    first: u64,
    is_record: impl Fn(&[u8]) -> bool,
    holder: &mut H,
    mut walk: impl FnMut(&mut H, &mut Positioned) -> Result<(), At<Stop>>,
) -> Result<(), OpenError> {
    let name = holder.intake().file().to_owned();
    let io = |error: io::Error| {
        OpenError::file(&name, format!("cannot be read ({error})"), "copy it to a sound disk")
    };
    file.seek_to(first).map_err(io)?;
    while let Err(At { start, stop }) = walk(holder, file) {
        let why = match stop {
            Stop::Refused(error) => return Err(error),
            Stop::Damaged(why) => why,
        };
        let progress = holder.intake().progress();
        let found =
            file.find(start + 1, |_| progress.check().map_err(io::Error::other), &is_record);
        progress.check()?;
        let found = found.map_err(io)?;
        holder.intake().lost(file.at() - start, format!("damaged at byte {start} ({why})"));
        if !found {
            break;
        }
    }
    Ok(())
}
