//! Comma-separated tables of numbers with a header.

use super::OpenError;

/// One row: the wanted columns in the order they were asked for.
pub struct Row {
    pub line: usize,
    /// Where it starts in the text.
    pub start_byte: u64,
    pub values: Vec<f64>,
}

impl Row {
    /// A value that must be a whole number.
    pub fn whole(&self, file: &str, index: usize, column: &str) -> Result<i64, OpenError> {
        let value = self.values[index];
        if value.fract() == 0.0 && value.abs() < 1e15 {
            Ok(value as i64)
        } else {
            let what = format!("{value} in column `{column}` is not a whole number");
            Err(OpenError::line(file, self.line, what, "correct or delete the line"))
        }
    }
}

/// Whether a header names all these columns, whatever separates them.
pub fn header_has(header: &str, columns: &[&str]) -> bool {
    let names: Vec<_> = header.split([',', ';', '\t', '|', ' ']).map(str::trim).collect();
    columns.iter().all(|column| names.iter().any(|name| name.eq_ignore_ascii_case(column)))
}

/// The named columns of a comma-separated table, wherever they stand, row by row.
///
/// A field that is not a number, a missing column, a row of another length or another separator is an
/// error with its line; `NaN` is a number here, and the caller's business.
pub fn rows<'a>(
    file: &'a str,
    text: &'a str,
    columns: &'a [&'a str],
) -> Result<impl Iterator<Item = Result<Row, OpenError>> + 'a, OpenError> {
    let header = text.lines().next().unwrap_or_default();
    if !header.contains(',') {
        let found = [(';', "semicolons"), ('\t', "tabs"), ('|', "bars"), (' ', "spaces")];
        let what = match found.iter().find(|(separator, _)| header.trim().contains(*separator)) {
            Some((_, name)) => format!("the columns are separated by {name}, not commas"),
            None => format!("the header `{}` is not comma-separated", header.trim()),
        };
        return Err(OpenError::line(file, 1, what, "save the table with commas"));
    }
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let names = reader.headers().map_err(|error| csv_error(file, &error))?.clone();
    let mut positions = Vec::with_capacity(columns.len());
    for column in columns {
        match names.iter().position(|name| name.eq_ignore_ascii_case(column)) {
            Some(position) => positions.push(position),
            None => {
                return Err(OpenError::line(
                    file,
                    1,
                    format!("no column `{column}`"),
                    format!("the header must name {}", columns.join(", ")),
                ));
            }
        }
    }
    let mut records = reader.into_records();
    Ok(std::iter::from_fn(move || {
        let record = records.next()?;
        Some(record.map_err(|error| csv_error(file, &error)).and_then(|record| {
            let (line, start_byte) =
                record.position().map_or((0, 0), |place| (place.line() as usize, place.byte()));
            let mut values = Vec::with_capacity(positions.len());
            for (position, column) in positions.iter().zip(columns) {
                let field = &record[*position];
                values.push(field.parse().map_err(|_| {
                    OpenError::line(
                        file,
                        line,
                        format!("`{field}` in column `{column}` is not a number"),
                        "correct or delete the line",
                    )
                })?);
            }
            Ok(Row { line, start_byte, values })
        }))
    }))
}

/// All of [`rows`].
pub fn read_columns(file: &str, text: &str, columns: &[&str]) -> Result<Vec<Row>, OpenError> {
    rows(file, text, columns)?.collect()
}

fn csv_error(file: &str, error: &csv::Error) -> OpenError {
    let line = error.position().map_or(1, |position| position.line() as usize);
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => OpenError::line(
            file,
            line,
            format!("{len} fields where the header has {expected_len}"),
            "the line may be cut short; complete or delete it",
        ),
        _ => OpenError::line(
            file,
            line,
            error.to_string(),
            "save the table as UTF-8 text with commas",
        ),
    }
}
