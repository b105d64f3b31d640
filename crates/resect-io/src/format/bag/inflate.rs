//! Decompression with a cap: a small file must not become gigabytes.
//!
//! Everything compressed in one file together may inflate to [`ALWAYS_ALLOWED_BYTES`] and [`LARGEST_RATIO`] times the size of
//! the file. Readings compress about three to one, whole recordings of a robot two to ten to one.

use std::cell::Cell;
use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::Path;

use crate::error::OpenError;
use resect_core::progress::Progress;

/// What a file may inflate to whatever its own size is.
pub const ALWAYS_ALLOWED_BYTES: u64 = 32 << 20;
/// What it may inflate to beyond that, in times its own size.
pub const LARGEST_RATIO: u64 = 100;
/// The memory that a zstd stream may ask for, as a power of two: 32 MiB. Writers of bags stay at 8 MiB.
const LARGEST_WINDOW_LOG: u32 = 25;
/// What every zstd frame begins with (RFC 8878, 3.1.1).
pub const ZSTD_MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// How many bytes may still come out of a file's compressed parts.
pub struct Budget {
    left: Cell<u64>,
    file_bytes: u64,
}

impl Budget {
    pub fn of_file(file_bytes: u64) -> Self {
        let allowed = ALWAYS_ALLOWED_BYTES + LARGEST_RATIO * file_bytes;
        Self { left: Cell::new(allowed), file_bytes }
    }

    /// Whether more came out than may.
    pub fn is_spent(&self) -> bool {
        self.left.get() == 0
    }

    /// What comes out of `reader`, an error as soon as it is too much.
    pub fn watch<R: Read>(&self, reader: R) -> Watched<'_, R> {
        Watched { reader, budget: self }
    }

    /// The line for the user.
    pub fn refusal(&self, file: &str) -> OpenError {
        let allowed = (ALWAYS_ALLOWED_BYTES + LARGEST_RATIO * self.file_bytes) >> 20;
        OpenError::file(
            file,
            format!(
                "its {} bytes inflate to more than {allowed} MiB, which no recording of readings does (the limit is {} MiB and \
                 {LARGEST_RATIO} times the file)",
                self.file_bytes,
                ALWAYS_ALLOWED_BYTES >> 20
            ),
            "if it is one, decompress it first (`rosbag decompress`, `zstd -d`, `ros2 bag convert`)",
        )
    }
}

pub struct Watched<'a, R> {
    reader: R,
    budget: &'a Budget,
}

impl<R: Read> Read for Watched<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.reader.read(buffer)?;
        self.budget.left.set(self.budget.left.get().saturating_sub(read as u64));
        if read > 0 && self.budget.is_spent() {
            return Err(io::Error::other("inflates to too much"));
        }
        Ok(read)
    }
}

/// A decoder by the name that ROS 1 and MCAP give it; `None` for an unknown one.
pub fn decoder<'a>(
    name: &str,
    compressed: impl Read + 'a,
) -> Option<io::Result<Box<dyn Read + 'a>>> {
    Some(Ok(match name {
        "bz2" => Box::new(bzip2::read::BzDecoder::new(compressed)),
        "lz4" => Box::new(lz4_flex::frame::FrameDecoder::new(compressed)),
        "zstd" => match zstd_decoder(compressed) {
            Ok(decoder) => Box::new(decoder),
            Err(error) => return Some(Err(error)),
        },
        _ => return None,
    }))
}

fn zstd_decoder<R: Read>(
    compressed: R,
) -> io::Result<zstd::stream::read::Decoder<'static, BufReader<R>>> {
    let mut decoder = zstd::stream::read::Decoder::new(compressed)?;
    decoder.window_log_max(LARGEST_WINDOW_LOG)?;
    Ok(decoder)
}

/// A message that was compressed on its own, as rosbag2 does by message; at most `largest` bytes, an error beyond that.
pub fn message(compressed: &[u8], largest: usize, into: &mut Vec<u8>) -> io::Result<()> {
    into.clear();
    zstd_decoder(compressed)?.take(largest as u64 + 1).read_to_end(into)?;
    if into.len() > largest {
        return Err(io::Error::other("inflates to too much"));
    }
    Ok(())
}

/// The first bytes of what a zstd file holds, at most `length`; fewer where it is damaged.
pub fn head(file: impl Read, length: u64) -> Vec<u8> {
    let mut head = Vec::new();
    if let Ok(decoder) = zstd_decoder(file) {
        // What came before the damage tells what it was.
        let _ = decoder.take(length).read_to_end(&mut head);
    }
    head
}

/// Inflates a whole file to a temporary one, which is gone when it is dropped. Where the file is cut or damaged, what came
/// before that is in it, and the second value says what is wrong.
pub fn to_temporary_file(
    path: &Path,
    budget: &Budget,
    file: &str,
    progress: &Progress,
) -> Result<(tempfile::NamedTempFile, Option<String>), OpenError> {
    let io = |error| OpenError::Io { path: path.to_owned(), error };
    let mut inflated = tempfile::Builder::new().prefix("resect-bag-").tempfile().map_err(io)?;
    let mut source = budget.watch(zstd_decoder(File::open(path).map_err(io)?).map_err(io)?);
    let mut buffer = vec![0; 1 << 17];
    loop {
        progress.check()?;
        match source.read(&mut buffer) {
            Ok(0) => return Ok((inflated, None)),
            Ok(read) => inflated.write_all(&buffer[..read]).map_err(io)?,
            Err(_) if budget.is_spent() => return Err(budget.refusal(file)),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => {
                return Ok((
                    inflated,
                    Some(format!("the compressed file is cut off or damaged ({error})")),
                ));
            }
        }
    }
}
