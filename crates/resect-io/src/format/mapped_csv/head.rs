//! The first rows of a table.

use std::borrow::Cow;

use crate::format::table::{self, LINES_ABOVE};
use crate::format::text_chunks::BYTE_ORDER_MARK;

/// Fewest named columns of an unknown table that may contain tracks: time, and three of a position.
const FEWEST_COLUMNS: usize = 4;
/// Fewest numbers in a row of tracks.
pub const FEWEST_NUMBERS: usize = 3;
/// Number of rows in a preview.
pub const PREVIEWED: usize = 20;

/// A line number with the fields of the row, or the reason why it has none.
pub type NumberedRow<'a> = (usize, Result<Vec<Cow<'a, str>>, String>);

/// Returns the header of a text, and its first complete rows.
pub fn first_rows(head: &str) -> (String, Vec<NumberedRow<'_>>) {
    let head = head.trim_start_matches(BYTE_ORDER_MARK);
    // A short file may end without a line end; a longer head may be cut off anywhere.
    let whole = if head.len() < 1024 { head } else { &head[..head.rfind('\n').unwrap_or(0)] };
    let lines: Vec<(usize, &str)> =
        whole.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()).collect();
    let at = header_index(&lines);
    let header = lines.get(at).map_or("", |(_, line)| table::uncommented(line)).to_owned();
    let separator = table::separator(&header);
    let expected = table::fields(&header, separator).map_or(0, |names| names.len());
    let rows = lines.iter().skip(at + 1).take(PREVIEWED);
    let rows = rows.map(|(index, line)| (index + 1, table::row_fields(line, separator, expected)));
    (header, rows.collect())
}

/// Returns the index of the header: names above a row of numbers, or else the first line that is no comment.
fn header_index(lines: &[(usize, &str)]) -> usize {
    let is_header = |pair: &[(usize, &str)]| {
        let header = table::uncommented(pair[0].1);
        let separator = table::separator(header);
        let names = table::fields(header, separator).unwrap_or_default();
        let row = table::row_fields(pair[1].1, separator, names.len()).unwrap_or_default();
        are_names(&names) && row.iter().filter(|field| is_numeric(field)).count() >= FEWEST_NUMBERS
    };
    let is_above = |line: &str| line.starts_with(['#', '%']) || line.starts_with("sep=");
    let first = || lines.iter().position(|(_, line)| !is_above(line)).unwrap_or(0);
    lines.windows(2).take(LINES_ABOVE).position(is_header).unwrap_or_else(first)
}

/// Returns true if all fields of a line are names of columns, and enough for tracks.
pub fn are_names(fields: &[Cow<'_, str>]) -> bool {
    let is_name = |name: &Cow<'_, str>| {
        name.len() < 60 && name.chars().any(char::is_alphabetic) && name.parse::<f64>().is_err()
    };
    fields.len() >= FEWEST_COLUMNS && fields.iter().all(is_name)
}

pub fn is_numeric(field: &str) -> bool {
    field.trim_start_matches(['+', '-', '.']).starts_with(|c: char| c.is_ascii_digit())
}
