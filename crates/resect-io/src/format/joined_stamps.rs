//! Stamps of scripts that join seconds and nanoseconds by a point without leading zeros: 1760000000.42186 for .000042186.

use std::io::Read;

use super::table::{fields, header_has, read_header, separator};
use super::text_chunks::TextChunks;
use super::text_encoding::utf8_or_latin1;
use crate::error::OpenError;
use resect_core::progress::Progress;

/// Least number of stamps that go back in a table whose stamps are joined.
const LEAST_BACK: usize = 5;

/// Returns the time of seconds and nanoseconds that were joined by a point without leading zeros (s); `None` for another number.
pub fn joined_s(field: &str) -> Option<f64> {
    let (seconds, nanoseconds) = field.split_once('.')?;
    let is_count = (1..=9).contains(&nanoseconds.len())
        && (nanoseconds == "0" || !nanoseconds.starts_with('0'));
    let (seconds, nanoseconds) = (seconds.parse::<u32>().ok()?, nanoseconds.parse::<u32>().ok()?);
    is_count.then(|| f64::from(seconds) + 1e-9 * f64::from(nanoseconds))
}

/// Returns true if the stamps in a column of a table go back, and would not if the digits behind the point were nanoseconds.
pub fn are_joined(file: &str, reader: impl Read, column: &str) -> Result<bool, OpenError> {
    let mut chunks = TextChunks::new(file, reader);
    let is_header = |line: &str| header_has(line, &[column]);
    let (header, _) = read_header(&mut chunks, &Progress::default(), is_header)?;
    let separator = separator(&header);
    let names = fields(&header, separator).unwrap_or_default();
    let Some(index) = names.iter().position(|name| name.eq_ignore_ascii_case(column)) else {
        return Ok(false);
    };
    let (mut back, mut last) = (0, None);
    while let Some(line) = chunks.line()? {
        let line = utf8_or_latin1(line);
        let row = fields(line.trim(), separator).unwrap_or_default();
        let Some(field) = row.get(index) else { continue };
        let Some((as_read_s, joined_s)) = field.parse::<f64>().ok().zip(joined_s(field)) else {
            return Ok(false);
        };
        if let Some((last_s, last_joined_s)) = last {
            back += usize::from(as_read_s < last_s);
            if joined_s < last_joined_s {
                return Ok(false);
            }
        }
        last = Some((as_read_s, joined_s));
    }
    Ok(back >= LEAST_BACK)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(stamp: impl Fn(u32) -> String) -> String {
        let rows = (0..200).map(|k| format!("{},{}\n", stamp(k), k % 3 + 1));
        "timestamp,id\n".to_owned() + &rows.collect::<String>()
    }

    #[test]
    fn joined_stamps_are_recognised_by_their_order() {
        let nanoseconds = |k: u32| (k % 10) * 100_000_000 + 42_186;
        let is_joined =
            |text: &str| are_joined("x.csv", text.as_bytes(), "timestamp").expect("text");
        assert!(is_joined(&table(|k| format!("{}.{}", 1_760_000_000 + k / 10, nanoseconds(k)))));
        assert!(!is_joined(&table(|k| format!(
            "{}.{:09}",
            1_760_000_000 + k / 10,
            nanoseconds(k)
        ))));
        // Two loggers in one file go back as well.
        assert!(!is_joined(&table(|k| format!("{}.{}", 1_760_000_000 + k % 7, 900 - k))));
    }
}
