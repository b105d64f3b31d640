//! The first rows of a table.

use std::borrow::Cow;

use crate::format::table;
use crate::format::text_chunks::BYTE_ORDER_MARK;

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

/// Returns the index of the header: the first line that is no comment, or the comment above it if that line is numbers.
fn header_index(lines: &[(usize, &str)]) -> usize {
    let is_above = |line: &str| line.starts_with(['#', '%']) || line.starts_with("sep=");
    let first = lines.iter().position(|(_, line)| !is_above(line)).unwrap_or(0);
    let begins_with_number = |line: &str| {
        let field = line.split([',', ';', '\t', '|', ' ']).next().unwrap_or_default();
        field.trim().parse::<f64>().is_ok()
    };
    let is_comment = |at: usize| lines[at].1.starts_with(['#', '%']);
    match lines.get(first) {
        Some((_, line)) if first > 0 && begins_with_number(line) && is_comment(first - 1) => {
            first - 1
        }
        _ => first,
    }
}
