//! Text as other programs save it, as UTF-8 with line feeds: UTF-16 with or without a byte-order mark, Latin-1, lone carriage returns.

use std::borrow::Cow;
use std::io::{Cursor, Read};

/// Number of bytes by which encoding and line ends are recognised.
const HEAD_BYTES: usize = 4096;

/// Two bytes per character, the low one first (true) or last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Utf16 {
    is_little_endian: bool,
}

impl Utf16 {
    /// Recognises UTF-16 by its mark, or by the zeros between ASCII characters; `None` for any other encoding.
    fn recognise(head: &[u8]) -> Option<Self> {
        let zeros = |odd: usize| {
            head.chunks_exact(2)
                .take(32)
                .filter(|pair| pair[odd] == 0 && pair[1 - odd] != 0)
                .count()
        };
        let pairs = head.len().min(64) / 2;
        match head {
            [0xff, 0xfe, ..] => Some(Self { is_little_endian: true }),
            [0xfe, 0xff, ..] => Some(Self { is_little_endian: false }),
            _ if pairs >= 4 && zeros(1) == pairs => Some(Self { is_little_endian: true }),
            _ if pairs >= 4 && zeros(0) == pairs => Some(Self { is_little_endian: false }),
            _ => None,
        }
    }

    fn unit(self, pair: &[u8]) -> u16 {
        let pair = [pair[0], pair[1]];
        if self.is_little_endian { u16::from_le_bytes(pair) } else { u16::from_be_bytes(pair) }
    }

    /// Decodes whole pairs of bytes; a half surrogate becomes U+FFFD.
    fn decode(self, bytes: &[u8]) -> String {
        let units = bytes.chunks_exact(2).map(|pair| self.unit(pair));
        char::decode_utf16(units)
            .map(|decoded| decoded.unwrap_or(char::REPLACEMENT_CHARACTER))
            .collect()
    }
}

/// Returns a text, or its beginning, as UTF-8 with line feeds and without a byte-order mark. Bytes that are not UTF-8 are Latin-1.
pub fn decode(bytes: &[u8]) -> Cow<'_, str> {
    let text = match Utf16::recognise(bytes) {
        Some(utf16) => Cow::Owned(utf16.decode(bytes)),
        None => utf8_or_latin1(bytes),
    };
    let text = match text {
        Cow::Borrowed(text) => {
            Cow::Borrowed(text.strip_prefix(super::BYTE_ORDER_MARK).unwrap_or(text))
        }
        Cow::Owned(mut text) => {
            if text.starts_with(super::BYTE_ORDER_MARK) {
                text.remove(0);
            }
            Cow::Owned(text)
        }
    };
    if has_lone_returns(&text) { Cow::Owned(text.replace('\r', "\n")) } else { text }
}

/// Returns a whole text as [`decode`], or `None` if it contains characters that no text has.
pub fn decode_text(bytes: &[u8]) -> Option<String> {
    let text = decode(bytes);
    let is_control = |c: char| c.is_control() && !matches!(c, '\t' | '\n' | '\r' | '\x0c' | '\x1a');
    (!text.chars().take(HEAD_BYTES).any(is_control)).then(|| text.into_owned())
}

/// Returns a line, or a text cut off anywhere.
pub fn utf8_or_latin1(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        // A character that is cut off at the end.
        Err(error) if error.error_len().is_none() => {
            String::from_utf8_lossy(&bytes[..error.valid_up_to()])
        }
        Err(_) => Cow::Owned(bytes.iter().map(|byte| char::from(*byte)).collect()),
    }
}

fn has_lone_returns(text: &str) -> bool {
    // The last character may be the first half of a line end.
    let head = &text.as_bytes()[..text.len().min(HEAD_BYTES)];
    let inside = &head[..head.len().saturating_sub(1)];
    inside.contains(&b'\r') && !head.contains(&b'\n')
}

/// Returns a reader of the same text with line feeds, as UTF-8 if it is UTF-16.
pub fn text_reader<'a>(mut source: impl Read + 'a) -> std::io::Result<Box<dyn Read + 'a>> {
    let mut head = Vec::new();
    source.by_ref().take(HEAD_BYTES as u64).read_to_end(&mut head)?;
    let utf16 = Utf16::recognise(&head);
    let decoded = utf16.map_or_else(|| utf8_or_latin1(&head), |it| Cow::Owned(it.decode(&head)));
    let has_lone_returns = has_lone_returns(&decoded);
    drop(decoded);
    let whole = Cursor::new(head).chain(source);
    let utf8: Box<dyn Read + 'a> = match utf16 {
        None => Box::new(whole),
        Some(utf16) => {
            Box::new(Utf16Reader { source: whole, utf16, raw: Vec::new(), text: Cursor::default() })
        }
    };
    Ok(if has_lone_returns { Box::new(ReturnsReplaced(utf8)) } else { utf8 })
}

/// Decodes UTF-16, some kilobytes at a time.
struct Utf16Reader<R> {
    source: R,
    utf16: Utf16,
    /// Bytes that are not decoded yet: half a character at most.
    raw: Vec<u8>,
    text: Cursor<Vec<u8>>,
}

impl<R: Read> Read for Utf16Reader<R> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        loop {
            let count = self.text.read(into)?;
            if count > 0 || into.is_empty() {
                return Ok(count);
            }
            let taken = self.source.by_ref().take(HEAD_BYTES as u64).read_to_end(&mut self.raw)?;
            let mut whole = self.raw.len() / 2 * 2;
            // The second half of a pair of surrogates may not be there yet.
            let is_first_half = |unit: u16| (0xd800..0xdc00).contains(&unit);
            if taken > 0
                && whole >= 2
                && is_first_half(self.utf16.unit(&self.raw[whole - 2..whole]))
            {
                whole -= 2;
            }
            if taken == 0 && whole == 0 {
                return Ok(0);
            }
            self.text = Cursor::new(self.utf16.decode(&self.raw[..whole]).into_bytes());
            self.raw.drain(..whole);
        }
    }
}

/// Replaces carriage returns by line feeds.
struct ReturnsReplaced<R>(R);

impl<R: Read> Read for ReturnsReplaced<R> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let count = self.0.read(into)?;
        into[..count].iter_mut().filter(|byte| **byte == b'\r').for_each(|byte| *byte = b'\n');
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "Größe [m];Höhe 🚗\n1,5;2,5\n";

    fn utf16(text: &str, mark: bool, is_little_endian: bool) -> Vec<u8> {
        let mark = mark.then_some(0xfeff).into_iter();
        let units = mark.chain(text.encode_utf16());
        units
            .flat_map(|unit| if is_little_endian { unit.to_le_bytes() } else { unit.to_be_bytes() })
            .collect()
    }

    #[test]
    fn every_encoding_gives_the_same_text() {
        let with_mark = format!("\u{feff}{TEXT}");
        let ascii = "timestamp,id,distance,ha,va\n1,1,2,3,1.5\n";
        let cases = [
            (TEXT.as_bytes().to_vec(), TEXT),
            (with_mark.into_bytes(), TEXT),
            (utf16(TEXT, true, true), TEXT),
            (utf16(TEXT, true, false), TEXT),
            (utf16(ascii, false, true), ascii),
            (utf16(ascii, false, false), ascii),
            (b"Gr\xf6\xdfe,\xb0\n1,2\n".to_vec(), "Größe,°\n1,2\n"),
            (b"a,b\r1,2\r3,4\r".to_vec(), "a,b\n1,2\n3,4\n"),
            (b"a,b\r\n1,2\r\n".to_vec(), "a,b\r\n1,2\r\n"),
        ];
        for (bytes, expected) in cases {
            assert_eq!(decode(&bytes), expected);
            let mut read = Vec::new();
            let mut reader = text_reader(&bytes[..]).expect("in memory");
            reader.read_to_end(&mut read).expect("in memory");
            assert_eq!(decode(&read), expected, "as a stream");
        }
    }

    #[test]
    fn a_long_text_is_decoded_across_its_pieces() {
        let text = TEXT.repeat(2000);
        let mut read = String::new();
        text_reader(&utf16(&text, true, true)[..])
            .and_then(|mut reader| reader.read_to_string(&mut read))
            .expect("in memory");
        assert!(read.strip_prefix('\u{feff}') == Some(&text));
    }

    #[test]
    fn pictures_are_no_text() {
        assert_eq!(decode_text(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"), None);
        assert_eq!(decode_text(b"1 2 3\n"), Some("1 2 3\n".to_owned()));
    }
}
