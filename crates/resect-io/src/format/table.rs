//! Text tables with a header: columns, numbers, and errors by line.
//!
//! Columns are separated by commas, semicolons, tabs, bars, or blanks. Unless separated by commas, numbers may have a decimal comma.
//! Lines above the header are skipped: comments, titles, a spreadsheet's `sep=;`.

use std::borrow::Cow;
use std::io::Read;

use super::text_chunks::TextChunks;
use super::text_encoding::utf8_or_latin1;
use crate::error::OpenError;
use crate::skipped_rows::SkippedRows;
use resect_core::progress::Progress;

/// One row: the wanted columns in the order requested.
#[derive(Debug, PartialEq)]
pub struct Row<const N: usize> {
    pub line: usize,
    pub values: [f64; N],
}

impl<const N: usize> Row<N> {
    /// Returns a value that must be a whole number, or the reason why it is not.
    pub fn whole(&self, index: usize, column: &str) -> Result<i64, String> {
        let value = self.values[index];
        if value.fract() == 0.0 && value.abs() < 1e15 {
            Ok(value as i64)
        } else {
            Err(format!("{value} in column `{column}` is not a whole number"))
        }
    }
}

pub const CORRECT: &str = "correct or delete the line";
const SEPARATORS: [char; 4] = [',', ';', '\t', '|'];
/// Number of lines among which the header is searched.
pub const LINES_ABOVE: usize = 30;
/// Entries of tables for a missing number.
const MISSING: [&str; 8] = ["", "-", "--", "---", "n/a", "na", "null", "none"];

/// Returns the separator of the columns: the most frequent one in the header; blanks if it has no other.
pub fn separator(header: &str) -> char {
    let count = |separator: &char| header.matches(*separator).count();
    // If equally frequent, the first: a comma.
    let separator = SEPARATORS.into_iter().rev().max_by_key(count).unwrap_or(',');
    if separator == ',' && has_decimal_commas(header) {
        return ' ';
    }
    if count(&separator) == 0 && header.trim().contains(' ') { ' ' } else { separator }
}

/// Returns true for numbers between blanks that have decimal commas: `17 0,5 1,25 -3,0`.
fn has_decimal_commas(row: &str) -> bool {
    let is_whole = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let is_number = |field: &str| match field.trim_start_matches('-').split_once(',') {
        Some((whole, decimals)) => is_whole(whole) && is_whole(decimals),
        None => is_whole(field),
    };
    let fields = || row.split_whitespace();
    fields().filter(|field| field.contains(',')).count() > 2 && fields().all(is_number)
}

/// Returns a header without the sign of a comment.
pub fn uncommented(header: &str) -> &str {
    header.trim().trim_start_matches(['#', '%']).trim()
}

/// Returns true if a header names all these columns, with any separator.
pub fn header_has(header: &str, columns: &[&str]) -> bool {
    let names: Vec<_> = uncommented(header).split([',', ';', '\t', '|', ' ']).map(bare).collect();
    columns.iter().all(|column| names.iter().any(|name| name.eq_ignore_ascii_case(column)))
}

/// Returns the first of the lines of a text that a reader of tables takes for its header.
pub fn header_line(text: &str, is_header: impl Fn(&str) -> bool) -> Option<&str> {
    text.lines().take(LINES_ABOVE).find(|line| is_header(line))
}

/// Calls `take` with the named columns of each row of a table, in any order of columns; `progress` counts bytes.
///
/// Returns the rows that are skipped: a field that is not a number, another number of fields than the header, or a reason that `take`
/// gives. A missing number is NaN. A missing column is an error, and so are more skipped rows than others.
pub fn for_each_row<const N: usize>(
    file: &str,
    reader: impl Read,
    columns: &[&str; N],
    progress: &Progress,
    mut take: impl FnMut(Row<N>) -> Result<(), String>,
) -> Result<SkippedRows, OpenError> {
    let mut chunks = TextChunks::new(file, reader);
    let is_header = |line: &str| header_has(line, columns);
    let (header, mut line) = read_header(&mut chunks, progress, is_header)?;
    let separator = separator(&header);
    let names =
        fields(&header, separator).map_err(|what| OpenError::line(file, line, what, CORRECT))?;
    let wanted = positions(file, line, &names, columns)?;
    let layout = TableLayout { separator, count: names.len(), wanted, columns };
    let mut slots = vec![None; names.len()];
    for (slot, position) in wanted.iter().enumerate() {
        slots[*position] = Some(slot);
    }
    let (mut skipped, mut valid) = (SkippedRows::default(), 0);
    while let Some(lines) = chunks.lines()? {
        let mut rest = lines;
        while !rest.is_empty() {
            line += 1;
            let (values, taken) = match plain_row(rest, separator as u8, &slots) {
                Some((values, taken)) => (Ok(Some(values)), taken),
                None => {
                    let end = memchr::memchr(b'\n', rest).map_or(rest.len(), |at| at + 1);
                    (layout.row(&rest[..end]), end)
                }
            };
            rest = &rest[taken..];
            match values
                .and_then(|values| values.map(|values| take(Row { line, values })).transpose())
            {
                Ok(None) => {}
                Ok(Some(())) => valid += 1,
                Err(reason) => skipped.add(line, reason),
            }
        }
        let bytes = lines.len() as u64;
        progress.advance(bytes)?;
    }
    skipped.refuse_if_most(file, valid, CORRECT)?;
    Ok(skipped)
}

/// Returns all rows of [`for_each_row`]; skipped ones are an error.
pub fn read_columns<const N: usize>(
    file: &str,
    text: &str,
    columns: &[&str; N],
) -> Result<Vec<Row<N>>, OpenError> {
    let mut rows = Vec::new();
    let skipped = for_each_row(file, text.as_bytes(), columns, &Progress::default(), |row| {
        rows.push(row);
        Ok(())
    })?;
    skipped.refuse_if_most(file, 0, CORRECT)?;
    Ok(rows)
}

/// Reads up to the header, and returns it without the sign of a comment, with its line: the first line that `is_header` accepts, or the
/// first that is not blank.
pub fn read_header(
    chunks: &mut TextChunks<impl Read>,
    progress: &Progress,
    is_header: impl Fn(&str) -> bool,
) -> Result<(String, usize), OpenError> {
    let mut first: Option<(String, usize)> = None;
    for number in 1..=LINES_ABOVE {
        let Some(line) = chunks.line()? else { break };
        progress.advance(line.len() as u64)?;
        let line = utf8_or_latin1(line);
        if is_header(&line) {
            return Ok((uncommented(&line).to_owned(), number));
        }
        if first.is_none() && !line.trim().is_empty() {
            first = Some((line.trim().to_owned(), number));
        }
    }
    Ok(first.unwrap_or((String::new(), 1)))
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
/// row, valid or not, which [`TableLayout::row`] parses.
fn plain_row<const N: usize>(
    text: &[u8],
    separator: u8,
    slots: &[Option<usize>],
) -> Option<([f64; N], usize)> {
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
            None => memchr::memchr3(separator, b'\n', b'"', rest).unwrap_or(rest.len()),
        };
        rest = past_spaces(&rest[length..]);
        let is_last = column + 1 == slots.len();
        rest = match (is_last, rest) {
            (false, [end, rest @ ..]) if *end == separator => rest,
            (true, [b'\n', rest @ ..] | [b'\r', b'\n', rest @ ..] | rest @ []) => rest,
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

/// The columns of a table.
struct TableLayout<'a, const N: usize> {
    separator: char,
    count: usize,
    wanted: [usize; N],
    columns: &'a [&'a str; N],
}

impl<const N: usize> TableLayout<'_, N> {
    /// Parses one line in general: quoted fields, blank lines (`None`), or the reason why it is not a row.
    fn row(&self, line: &[u8]) -> Result<Option<[f64; N]>, String> {
        let line = utf8_or_latin1(line);
        if line.trim().is_empty() {
            return Ok(None);
        }
        let fields = row_fields(&line, self.separator, self.count)?;
        let mut values = [0.0; N];
        for ((value, position), column) in values.iter_mut().zip(self.wanted).zip(self.columns) {
            let field = &fields[position];
            *value = number(field, self.separator != ',')
                .map_err(|what| format!("`{}` in column `{column}` {what}", shown(field)))?;
        }
        Ok(Some(values))
    }
}

/// Splits a row of a table with so many columns, or returns the reason why it is not one. An empty field behind the last is ignored.
pub fn row_fields(line: &str, separator: char, count: usize) -> Result<Vec<Cow<'_, str>>, String> {
    let mut fields = fields(line.trim_end_matches(['\r', '\n']), separator)?;
    if fields.len() == count + 1 && fields[count].is_empty() {
        fields.pop();
    }
    match fields.len() {
        own if own == count => Ok(fields),
        own if own == count + 1 => Err(format!(
            "{own} fields where the header has {count}; a column of row numbers has no name"
        )),
        own => Err(format!("{own} fields where the header has {count}; the line may be cut short")),
    }
}

/// Parses a number; NaN for a missing one. The error completes a sentence that begins with the field.
pub fn number(field: &str, decimal_comma: bool) -> Result<f64, String> {
    let field = with_point(field.trim(), decimal_comma);
    if let Ok(value) = field.parse() {
        return Ok(value);
    }
    if MISSING.iter().any(|missing| field.eq_ignore_ascii_case(missing)) {
        return Ok(f64::NAN);
    }
    without_thousands(&field).ok_or_else(|| "is not a number".to_owned())
}

/// Returns the number of `1,234,567.8`; `None` if a comma may be a decimal one.
fn without_thousands(field: &str) -> Option<f64> {
    let (whole, decimals) = field.split_once('.')?;
    let mut groups = whole.trim_start_matches(['+', '-']).split(',');
    let is_first = groups.next().is_some_and(|group| (1..=3).contains(&group.len()));
    let is_plain = decimals.chars().all(|c| c.is_ascii_digit());
    let is_grouped = is_first && is_plain && groups.all(|group| group.len() == 3);
    is_grouped.then(|| field.replace(',', "").parse().ok()).flatten()
}

/// Returns the field with a decimal point instead of a decimal comma, if the table may have one.
pub fn with_point(field: &str, decimal_comma: bool) -> Cow<'_, str> {
    if decimal_comma && field.contains(',') && !field.contains('.') {
        Cow::Owned(field.replacen(',', ".", 1))
    } else {
        Cow::Borrowed(field)
    }
}

/// Splits a line without its end into fields, trimmed and without quotes; the error describes the fault. Several blanks are one separator.
pub fn fields(line: &str, separator: char) -> Result<Vec<Cow<'_, str>>, String> {
    if separator == ' ' {
        return Ok(line.split_whitespace().map(|field| Cow::Borrowed(bare(field))).collect());
    }
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
