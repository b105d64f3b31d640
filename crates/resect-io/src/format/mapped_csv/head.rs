//! The first rows of a table.

use std::borrow::Cow;

use crate::format::table;
use crate::format::text_chunks::BYTE_ORDER_MARK;

/// Number of rows in a preview.
pub const PREVIEWED: usize = 20;
const SEPARATORS: [char; 4] = [',', ';', '\t', '|'];

/// A line number with the fields of the row, or the reason why it has none.
pub type NumberedRow<'a> = (usize, Result<Vec<Cow<'a, str>>, String>);

/// Returns the header of a text, and its first complete rows.
pub fn first_rows(head: &str) -> (String, Vec<NumberedRow<'_>>) {
    let head = head.trim_start_matches(BYTE_ORDER_MARK);
    // A short file may end without a line end; a longer head may be cut off anywhere.
    let whole = if head.len() < 1024 { head } else { &head[..head.rfind('\n').unwrap_or(0)] };
    let mut lines =
        whole.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()).take(PREVIEWED + 1);
    let header = lines.next().map_or("", |(_, line)| line).trim().to_owned();
    let separator = separator(&header);
    let expected = table::fields(&header, separator).map_or(0, |names| names.len());
    let rows = lines.map(|(index, line)| {
        let fields = table::fields(line, separator).and_then(|fields| match fields.len() {
            count if count == expected => Ok(fields),
            count => Err(format!("{count} fields where the header has {expected}")),
        });
        (index + 1, fields)
    });
    (header, rows.collect())
}

/// Returns the separator of the columns: the most frequent one in the header.
pub fn separator(header: &str) -> char {
    let count = |separator: &char| header.matches(*separator).count();
    // If equally frequent, the first: a comma.
    SEPARATORS.into_iter().rev().max_by_key(count).unwrap_or(',')
}
