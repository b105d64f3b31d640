//! Decompression with a limit, against small files that inflate to gigabytes.
//!
//! All compressed data of one file together may inflate to [`ALWAYS_ALLOWED_BYTES`] plus [`LARGEST_RATIO`] times the size of the
//! file. Readings compress about three to one, whole recordings of a robot two to ten to one.

use std::cell::Cell;
use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::Path;

use crate::error::OpenError;
use resect_core::progress::Progress;

/// Inflated bytes allowed for a file of any size.
pub const ALWAYS_ALLOWED_BYTES: u64 = 32 << 20;
/// Inflated bytes allowed beyond that, as a multiple of the file's size.
pub const LARGEST_RATIO: u64 = 100;
/// Largest window of a zstd stream, as a power of two: 32 MiB. Writers of bags stay at 8 MiB.
const LARGEST_WINDOW_LOG: u32 = 25;
/// First bytes of every zstd frame (RFC 8878, 3.1.1).
pub const ZSTD_MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// Number of bytes that a file's compressed data may still inflate to.
pub struct Budget {
    left: Cell<u64>,
    file_bytes: u64,
}

impl Budget {
    pub fn of_file(file_bytes: u64) -> Self {
        let allowed = ALWAYS_ALLOWED_BYTES + LARGEST_RATIO * file_bytes;
        Self { left: Cell::new(allowed), file_bytes }
    }

    /// Returns true if the limit is reached.
    pub fn is_spent(&self) -> bool {
        self.left.get() == 0
    }

    /// Wraps a decoder; reading from it fails once the limit is exceeded.
    pub fn watch<R: Read>(&self, reader: R) -> Watched<'_, R> {
        Watched { reader, budget: self }
    }

    /// The error of a file that exceeds the limit.
    pub fn refusal(&self, file: &str) -> OpenError {
        let allowed = (ALWAYS_ALLOWED_BYTES + LARGEST_RATIO * self.file_bytes) >> 20;
        OpenError::file(
            file,
            format!(
                "too large for a recording of readings: its {} bytes decompress to more than {allowed} MiB (the limit \
                 is {} MiB and {LARGEST_RATIO} times the file)",
                self.file_bytes,
                ALWAYS_ALLOWED_BYTES >> 20
            ),
            "if it is a recording, decompress it first (`rosbag decompress`, `zstd -d`, `ros2 bag convert`)",
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
            return Err(io::Error::other("too large when decompressed"));
        }
        Ok(read)
    }
}

/// Returns a decoder by its name in ROS 1 and MCAP; `None` for an unknown name.
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

/// Inflates a message compressed on its own, as rosbag2 does in the mode by message; an error beyond `largest` bytes.
pub fn message(compressed: &[u8], largest: usize, into: &mut Vec<u8>) -> io::Result<()> {
    into.clear();
    zstd_decoder(compressed)?.take(largest as u64 + 1).read_to_end(into)?;
    if into.len() > largest {
        return Err(io::Error::other("too large when decompressed"));
    }
    Ok(())
}

/// Returns the first `length` bytes of a zstd file's content; fewer if it is damaged.
pub fn head(file: impl Read, length: u64) -> Vec<u8> {
    let mut head = Vec::new();
    if let Ok(decoder) = zstd_decoder(file) {
        // The bytes before the damage suffice to recognise the file.
        let _ = decoder.take(length).read_to_end(&mut head);
    }
    head
}

/// Inflates a file into a temporary one, removed when dropped. If the file is cut off or damaged, the temporary one contains the
/// bytes before that, and the second value describes the damage.
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
