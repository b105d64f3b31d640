//! Reading of text of any size, a few hundred kilobytes of whole lines at a time.

use std::io::Read;

use crate::error::OpenError;

/// Character that some editors write before UTF-8 text.
pub const BYTE_ORDER_MARK: char = '\u{feff}';

const CHUNK_BYTES: usize = 1 << 18;
/// Longer lines are no rows of measurements; a file without any line end must not fill the memory.
const LONGEST_LINE_BYTES: usize = 1 << 20;

/// Returns the whole lines of a text, in order.
pub struct TextChunks<R> {
    file: String,
    reader: R,
    buffer: Vec<u8>,
    /// Bytes of the buffer that are read and not returned yet.
    start: usize,
    filled: usize,
    ended: bool,
    at_beginning: bool,
}

impl<R: Read> TextChunks<R> {
    /// Reads from `reader`; errors name `file`.
    pub fn new(file: &str, reader: R) -> Self {
        let buffer = vec![0; CHUNK_BYTES];
        let file = file.to_owned();
        Self { file, reader, buffer, start: 0, filled: 0, ended: false, at_beginning: true }
    }

    /// Returns the next line, with its end; `None` after the last.
    pub fn line(&mut self) -> Result<Option<&[u8]>, OpenError> {
        let whole = self.fill()?;
        let end = memchr::memchr(b'\n', whole).map_or(whole.len(), |at| at + 1);
        Ok(self.hand_out(end))
    }

    /// Returns several whole lines, with their ends; `None` after the last.
    pub fn lines(&mut self) -> Result<Option<&[u8]>, OpenError> {
        let whole = self.fill()?.len();
        Ok(self.hand_out(whole))
    }

    fn hand_out(&mut self, bytes: usize) -> Option<&[u8]> {
        let from = self.start;
        self.start += bytes;
        (bytes > 0).then(|| &self.buffer[from..from + bytes])
    }

    /// Reads until there is a whole line, and returns all whole lines in the buffer; empty at the end of the text.
    fn fill(&mut self) -> Result<&[u8], OpenError> {
        loop {
            let waiting = &self.buffer[self.start..self.filled];
            if let Some(last) = memchr::memrchr(b'\n', waiting) {
                return Ok(&self.buffer[self.start..=self.start + last]);
            }
            if self.ended {
                return Ok(&self.buffer[self.start..self.filled]);
            }
            self.read_on()?;
        }
    }

    fn read_on(&mut self) -> Result<(), OpenError> {
        self.buffer.copy_within(self.start..self.filled, 0);
        (self.start, self.filled) = (0, self.filled - self.start);
        if self.filled == self.buffer.len() {
            if self.filled >= LONGEST_LINE_BYTES {
                let what = "has a line of more than a megabyte";
                return Err(OpenError::file(&self.file, what, "it is not a table of measurements"));
            }
            self.buffer.resize(2 * self.filled, 0);
        }
        match self.reader.read(&mut self.buffer[self.filled..]) {
            Ok(0) => self.ended = true,
            Ok(read) => self.filled += read,
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
            Err(error) => {
                let what = format!("cannot be read further ({error})");
                return Err(OpenError::file(&self.file, what, "check the disk and copy it again"));
            }
        }
        let mark = BYTE_ORDER_MARK.len_utf8();
        if self.at_beginning && (self.filled >= mark || self.ended) {
            self.at_beginning = false;
            let begins = &self.buffer[..self.filled];
            if begins.starts_with(BYTE_ORDER_MARK.encode_utf8(&mut [0; 4]).as_bytes()) {
                self.start = mark;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reader that returns a few bytes at a time, as a slow disk may.
    struct Drops<'a>(&'a [u8], usize);

    impl Read for Drops<'_> {
        fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
            let count = self.1.min(self.0.len()).min(into.len());
            into[..count].copy_from_slice(&self.0[..count]);
            self.0 = &self.0[count..];
            Ok(count)
        }
    }

    #[test]
    fn lines_are_whole_however_they_arrive() {
        let text = "\u{feff}a,b\r\n1,2\n\n3,4";
        for drop in 1..text.len() {
            let mut chunks = TextChunks::new("x", Drops(text.as_bytes(), drop));
            assert_eq!(chunks.line().expect("readable"), Some(&b"a,b\r\n"[..]), "{drop}");
            let mut rest = Vec::new();
            while let Some(lines) = chunks.lines().expect("readable") {
                assert!(lines.ends_with(b"\n") || lines.ends_with(b"3,4"), "{drop}: {lines:?}");
                rest.extend_from_slice(lines);
            }
            assert_eq!(rest, b"1,2\n\n3,4", "{drop}");
        }
    }

    #[test]
    fn a_line_without_end_does_not_fill_the_memory() {
        let mut chunks = TextChunks::new("x", std::io::repeat(b'1'));
        let error = chunks.lines().expect_err("endless").to_string();
        assert!(error.contains("more than a megabyte"), "{error}");
        assert!(chunks.buffer.len() <= 2 * LONGEST_LINE_BYTES);
    }
}
