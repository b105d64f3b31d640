//! Text tables with a header: columns, numbers, and errors by line.

use std::borrow::Cow;
use std::io::Read;

use super::text_chunks::TextChunks;
use crate::error::OpenError;
use resect_core::progress::Progress;

/// One row: the wanted columns in the order requested.
#[derive(Debug, PartialEq)]
pub struct Row<const N: usize> {
    pub line: usize,
    pub values: [f64; N],
}

impl<const N: usize> Row<N> {
    /// Returns a value that must be a whole number.
    pub fn whole(&self, file: &str, index: usize, column: &str) -> Result<i64, OpenError> {
        let value = self.values[index];
        if value.fract() == 0.0 && value.abs() < 1e15 {
            Ok(value as i64)
        } else {
            let what = format!("{value} in column `{column}` is not a whole number");
            Err(OpenError::line(file, self.line, what, CORRECT))
        }
    }
}

const CORRECT: &str = "correct or delete the line";

/// Returns true if a header names all these columns, with any separator.
pub fn header_has(header: &str, columns: &[&str]) -> bool {
    let names: Vec<_> = header.split([',', ';', '\t', '|', ' ']).map(bare).collect();
    columns.iter().all(|column| names.iter().any(|name| name.eq_ignore_ascii_case(column)))
}

/// Calls `take` with the named columns of each row of a comma-separated table, in any order of columns; `progress` counts bytes.
///
/// A field that is not a number, a missing column, a row of another length or another separator is an error with its line. `NaN` is
/// passed on as a number.
pub fn for_each_row<const N: usize>(
    file: &str,
    reader: impl Read,
    columns: &[&str; N],
    progress: &Progress,
    mut take: impl FnMut(Row<N>) -> Result<(), OpenError>,
) -> Result<(), OpenError> {
    let mut chunks = TextChunks::new(file, reader);
    let (header, mut line) = read_header(file, &mut chunks, progress)?;
    let names = comma_separated(file, line, &header)?;
    let wanted = positions(file, line, &names, columns)?;
    let mut slots = vec![None; names.len()];
    for (slot, position) in wanted.iter().enumerate() {
        slots[*position] = Some(slot);
    }
    while let Some(lines) = chunks.lines()? {
        let mut rest = lines;
        while !rest.is_empty() {
            line += 1;
            let (values, taken) = match plain_row(rest, &slots) {
                Some((values, taken)) => (Some(values), taken),
                None => {
                    let end = memchr::memchr(b'\n', rest).map_or(rest.len(), |at| at + 1);
                    (any_row(file, line, &rest[..end], names.len(), &wanted, columns)?, end)
                }
            };
            rest = &rest[taken..];
            if let Some(values) = values {
                take(Row { line, values })?;
            }
        }
        let bytes = lines.len() as u64;
        progress.advance(bytes)?;
    }
    Ok(())
}

/// Returns all rows of [`for_each_row`].
pub fn read_columns<const N: usize>(
    file: &str,
    text: &str,
    columns: &[&str; N],
) -> Result<Vec<Row<N>>, OpenError> {
    let mut rows = Vec::new();
    for_each_row(file, text.as_bytes(), columns, &Progress::default(), |row| {
        rows.push(row);
        Ok(())
    })?;
    Ok(rows)
}

/// Reads the first line that is not blank, and its number.
pub fn read_header(
    file: &str,
    chunks: &mut TextChunks<impl Read>,
    progress: &Progress,
) -> Result<(String, usize), OpenError> {
    let mut number = 0;
    while let Some(line) = chunks.line()? {
        number += 1;
        progress.advance(line.len() as u64)?;
        if !line.trim_ascii().is_empty() {
            return Ok((utf8(file, number, line)?.trim().to_owned(), number));
        }
    }
    Ok((String::new(), 1))
}

fn comma_separated<'a>(
    file: &str,
    line: usize,
    header: &'a str,
) -> Result<Vec<Cow<'a, str>>, OpenError> {
    if !header.contains(',') {
        let found = [(';', "semicolons"), ('\t', "tabs"), ('|', "bars"), (' ', "spaces")];
        let what = match found.iter().find(|(separator, _)| header.contains(*separator)) {
            Some((_, name)) => format!("the columns are separated by {name}, not commas"),
            None => format!("the header `{}` is not comma-separated", shown(header)),
        };
        return Err(OpenError::line(file, line, what, "save the table with commas"));
    }
    fields(header, ',').map_err(|what| OpenError::line(file, line, what, CORRECT))
}

/// Returns the indices of the wanted columns.
fn positions<const N: usize>(
    file: &str,
    line: usize,
    names: &[Cow<'_, str>],
    columns: &[&str; N],
) -> Result<[usize; N], OpenError> {
    let mut positions = [0; N];
    for (position, column) in positions.iter_mut().zip(columns) {
        let found = names.iter().position(|name| name.eq_ignore_ascii_case(column));
        *position = found.ok_or_else(|| {
            let remedy = format!("the header must name {}", columns.join(", "));
            OpenError::line(file, line, format!("no column `{column}`"), remedy)
        })?;
    }
    Ok(positions)
}

/// Parses the first row of a text and returns its length in bytes: the fast path, for rows of plain numbers. `None` for any other
/// row, valid or not, which [`any_row`] parses.
fn plain_row<const N: usize>(text: &[u8], slots: &[Option<usize>]) -> Option<([f64; N], usize)> {
    let mut values = [0.0; N];
    let mut rest = text;
    for (column, slot) in slots.iter().enumerate() {
        rest = past_spaces(rest);
        let length = match slot {
            Some(slot) => {
                let (value, length) = fast_float2::parse_partial(rest).ok()?;
                values[*slot] = value;
                length
            }
            None => memchr::memchr3(b',', b'\n', b'"', rest).unwrap_or(rest.len()),
        };
        rest = past_spaces(&rest[length..]);
        let is_last = column + 1 == slots.len();
        rest = match (is_last, rest) {
            (false, [b',', rest @ ..])
            | (true, [b'\n', rest @ ..] | [b'\r', b'\n', rest @ ..] | rest @ []) => rest,
            // A skipped field may end with a carriage return.
            _ => return None,
        };
    }
    Some((values, text.len() - rest.len()))
}

fn past_spaces(mut text: &[u8]) -> &[u8] {
    while let [b' ', rest @ ..] = text {
        text = rest;
    }
    text
}

/// Parses one line in general: quoted fields, blank lines (`None`), and all errors.
fn any_row<const N: usize>(
    file: &str,
    number: usize,
    line: &[u8],
    expected: usize,
    wanted: &[usize; N],
    columns: &[&str; N],
) -> Result<Option<[f64; N]>, OpenError> {
    let line = utf8(file, number, line)?.trim();
    if line.is_empty() {
        return Ok(None);
    }
    let fields = fields(line, ',').map_err(|what| OpenError::line(file, number, what, CORRECT))?;
    if fields.len() != expected {
        return Err(wrong_length(file, number, fields.len(), expected));
    }
    let mut values = [0.0; N];
    for ((value, position), column) in values.iter_mut().zip(wanted).zip(columns) {
        let field = &fields[*position];
        *value = field.parse().map_err(|_| {
            let what = format!("`{}` in column `{column}` is not a number", shown(field));
            OpenError::line(file, number, what, CORRECT)
        })?;
    }
    Ok(Some(values))
}

/// The error of a row that has another number of fields than the header.
pub fn wrong_length(file: &str, line: usize, fields: usize, expected: usize) -> OpenError {
    let what = format!("{fields} fields where the header has {expected}");
    OpenError::line(file, line, what, "the line may be cut short; complete or delete it")
}

/// Returns a line as text.
pub fn utf8<'a>(file: &str, number: usize, line: &'a [u8]) -> Result<&'a str, OpenError> {
    std::str::from_utf8(line)
        .map_err(|_| OpenError::line(file, number, "not UTF-8 text", "save it as UTF-8"))
}

/// Splits a line without its end into fields, trimmed and without quotes; the error describes the fault.
pub fn fields(line: &str, separator: char) -> Result<Vec<Cow<'_, str>>, String> {
    let mut fields = Vec::new();
    let mut rest = line;
    loop {
        let end = match rest.trim_start_matches(' ').strip_prefix('"') {
            None => rest.find(separator),
            Some(quoted) => {
                let begin = rest.len() - quoted.len();
                let close =
                    closing_quote(quoted).ok_or("a quoted field runs over the end of the line")?;
                let after = &rest[begin + close + 1..];
                let end = after.find(separator);
                if !after[..end.unwrap_or(after.len())].trim().is_empty() {
                    return Err(format!("`{}` stands behind a closing quote", shown(after)));
                }
                end.map(|at| begin + close + 1 + at)
            }
        };
        let field = &rest[..end.unwrap_or(rest.len())];
        fields.push(match bare(field) {
            name if name.contains("\"\"") => Cow::Owned(name.replace("\"\"", "\"")),
            name => Cow::Borrowed(name),
        });
        match end {
            Some(end) => rest = &rest[end + separator.len_utf8()..],
            None => return Ok(fields),
        }
    }
}

/// Returns the position of the quote that ends a quoted field; doubled quotes are part of it.
fn closing_quote(quoted: &str) -> Option<usize> {
    let mut at = 0;
    loop {
        at += quoted[at..].find('"')?;
        if !quoted[at + 1..].starts_with('"') {
            return Some(at);
        }
        at += 2;
    }
}

/// Returns a field without surrounding space and quotes.
fn bare(field: &str) -> &str {
    let field = field.trim();
    field.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).map_or(field, str::trim)
}

/// Returns text of a file for a message: shortened, with control characters escaped.
pub fn shown(text: &str) -> String {
    const LONGEST: usize = 60;
    let mut shown: String = text.trim().chars().take(LONGEST).flat_map(printable).collect();
    if text.trim().chars().nth(LONGEST).is_some() {
        shown.push('…');
    }
    shown
}

fn printable(character: char) -> impl Iterator<Item = char> {
    let (as_it_is, escaped) = if character.is_control() || is_unseen(character) {
        (None, Some(character.escape_unicode()))
    } else {
        (Some(character), None)
    };
    as_it_is.into_iter().chain(escaped.into_iter().flatten())
}

/// Returns true for an invisible character that changes the display of its neighbours.
fn is_unseen(character: char) -> bool {
    matches!(character, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

#[cfg(test)]
mod tests;
