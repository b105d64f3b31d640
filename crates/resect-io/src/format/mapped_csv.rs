//! Reading of any table of tracks with a header, by the user's mapping of its columns ([`ColumnMapping`]).
//!
//! Columns are separated by commas, semicolons, tabs or bars; unless separated by commas, numbers may have a decimal comma. An empty
//! number means no reading, and is counted.

mod head;
mod stamps;
mod suggestion;
mod values;

use crate::findings::tracks::{rows_skipped, table_columns};
use std::borrow::Cow;
use std::f64::consts::TAU;
use std::io::Read;

use self::head::{FEWEST_NUMBERS, are_names, first_rows, is_numeric};
use self::stamps::Stamps;
pub use self::stamps::calendar_s;
pub use self::suggestion::{suggest, suggest_meanings};
use self::values::{angle_rad, metres, station_number};
use super::polar_csv;
use super::table::{self, number, separator, shown};
use super::text_chunks::TextChunks;
use super::text_encoding::utf8_or_latin1;
use crate::error::OpenError;
use crate::recording::Recording;
use crate::skipped_rows::SkippedRows;
use resect_core::deployment::ColumnMapping;
use resect_core::deployment::VerticalAngle;
use resect_core::deployment::{Measurement, RawRecord};
use resect_core::geometry::Polar;
use resect_core::progress::Progress;

const REMEDY: &str = "correct the line, or [columns] in deployment.toml";

/// The first rows of a table, as text and as records.
#[derive(Clone, Debug, PartialEq)]
pub struct Preview {
    pub header: Vec<String>,
    /// The first twenty rows.
    pub rows: Vec<Vec<String>>,
    /// Records of the rows, or the reason why a row is not one. Without a column of stations, all are station 1's.
    pub read: Vec<Result<RawRecord, String>>,
}

/// Applies a mapping to a table that begins with `head`; the last line may be cut off and is ignored.
pub fn preview(head: &str, mapping: &ColumnMapping) -> Preview {
    let (header, rows) = first_rows(head);
    let columns = MappedColumns::of(&header, separator(&header), mapping);
    let mut stamps = Stamps::default();
    let read = rows.iter().map(|(line, row)| match (&columns, row) {
        (Err(what), _) | (_, Err(what)) => Err(what.clone()),
        (Ok(columns), Ok(row)) => {
            columns.understand(row, *line, Some(1), &mut stamps).and_then(within_a_turn)
        }
    });
    let read = read.collect();
    let text = |fields: &[Cow<'_, str>]| fields.iter().map(|field| shown(field)).collect();
    Preview {
        header: table::fields(&header, separator(&header)).map_or(Vec::new(), |names| text(&names)),
        rows: rows
            .iter()
            .map(|(_, row)| row.as_ref().map_or(Vec::new(), |row| text(row)))
            .collect(),
        read,
    }
}

/// Refuses a reading if its angles cannot be in the chosen unit.
fn within_a_turn(record: RawRecord) -> Result<RawRecord, String> {
    let Measurement { azimuth_rad, zenith_rad, .. } = record.measurement;
    if azimuth_rad.abs() > TAU || zenith_rad.abs() > TAU {
        return Err(format!(
            "the angles are in another unit: azimuth {:.1}°, zenith angle {:.1}° is more than a turn",
            azimuth_rad.to_degrees(),
            zenith_rad.to_degrees()
        ));
    }
    Ok(record)
}

/// Reads a whole table; `progress` counts its bytes. `station` is the station number if no column contains it.
pub fn read(
    file: &str,
    reader: impl Read,
    mapping: &ColumnMapping,
    station: Option<i64>,
    progress: &Progress,
    into: &mut Recording,
) -> Result<(), OpenError> {
    into.begin_file(file, "line");
    let mut chunks = TextChunks::new(file, reader);
    let is_header = |line: &str| fits(line, mapping);
    let (header, mut line_number) = table::read_header(&mut chunks, progress, is_header)?;
    let columns = MappedColumns::of(&header, separator(&header), mapping).map_err(|what| {
        OpenError::line(file, line_number, what, "correct [columns] in deployment.toml")
    })?;
    let mut stamps = Stamps::default();
    let (mut skipped, mut valid) = (SkippedRows::default(), 0);
    while let Some(line) = chunks.line()? {
        line_number += 1;
        progress.advance(line.len() as u64)?;
        let line = utf8_or_latin1(line);
        if line.trim().is_empty() {
            continue;
        }
        let fields = table::row_fields(&line, columns.separator, columns.count);
        match fields
            .and_then(|fields| columns.understand(&fields, line_number, station, &mut stamps))
        {
            Ok(record) => {
                into.push(&record);
                valid += 1;
            }
            Err(reason) => skipped.add(line_number, reason),
        }
    }
    skipped.refuse_if_most(file, valid, REMEDY)?;
    if valid == 0 {
        return Err(polar_csv::no_measurement(file));
    }
    into.findings.extend(rows_skipped(file, &skipped));
    if matches!(columns.position, PositionColumns::Cartesian(_)) {
        into.ranges_include_prism_constant = true;
    }
    into.findings.push(table_columns(file, &columns.said()));
    Ok(())
}

/// Returns true if a text begins like a table of tracks: a header of names, and numbers below.
pub fn looks_like(head: &str) -> bool {
    let (header, rows) = first_rows(head);
    let Ok(names) = table::fields(&header, separator(&header)) else { return false };
    let Some((_, Ok(first))) = rows.first() else { return false };
    are_names(&names)
        && first.len() == names.len()
        && first.iter().filter(|field| is_numeric(field)).count() >= FEWEST_NUMBERS
}

/// Returns the header of a table that begins with `head`: the line that has all columns of a mapping.
pub fn header_of<'a>(head: &'a str, mapping: &ColumnMapping) -> Option<&'a str> {
    table::header_line(head, |line| fits(line, mapping))
}

/// Returns the reason why a table that begins with `head` does not fit a mapping; empty if it fits.
pub fn misfit(head: &str, mapping: &ColumnMapping) -> String {
    let header = likely_header(head);
    MappedColumns::of(&header, separator(&header), mapping).err().unwrap_or_default()
}

/// Returns the most probable header of an unknown table that begins with `head`.
pub fn likely_header(head: &str) -> String {
    first_rows(head).0
}

fn fits(line: &str, mapping: &ColumnMapping) -> bool {
    let header = table::uncommented(line);
    MappedColumns::of(header, separator(header), mapping).is_ok()
}

/// A mapping with the indices of its columns.
struct MappedColumns<'m> {
    mapping: &'m ColumnMapping,
    separator: char,
    count: usize,
    time: usize,
    station: Option<usize>,
    status: Option<usize>,
    position: PositionColumns,
}

enum PositionColumns {
    /// Range, azimuth, vertical angle.
    Polar([usize; 3]),
    Cartesian([usize; 3]),
}

impl<'m> MappedColumns<'m> {
    fn of(header: &str, separator: char, mapping: &'m ColumnMapping) -> Result<Self, String> {
        let names = table::fields(header, separator)?;
        let find = |column: &str| {
            let found = names.iter().position(|name| name.eq_ignore_ascii_case(column.trim()));
            found.ok_or_else(|| {
                let names = names.join(", ");
                format!("no column `{}` among {}", shown(column), shown(&names))
            })
        };
        let maybe = |column: &Option<String>| column.as_deref().map(find).transpose();
        if mapping.time.trim().is_empty() {
            return Err("no time column is given".to_owned());
        }
        let ColumnMapping { range, azimuth, vertical, x, y, z, .. } = mapping;
        let polar = [maybe(range)?, maybe(azimuth)?, maybe(vertical)?];
        let cartesian = [maybe(x)?, maybe(y)?, maybe(z)?];
        let position = match (polar, cartesian) {
            ([Some(range), Some(azimuth), Some(vertical)], [None, None, None]) => {
                PositionColumns::Polar([range, azimuth, vertical])
            }
            ([None, None, None], [Some(x), Some(y), Some(z)]) => {
                PositionColumns::Cartesian([x, y, z])
            }
            _ => {
                return Err(
                    "give the columns of range, azimuth and vertical, or those of x, y and z"
                        .to_owned(),
                );
            }
        };
        Ok(Self {
            mapping,
            separator,
            count: names.len(),
            time: find(&mapping.time)?,
            station: maybe(&mapping.station)?,
            status: maybe(&mapping.status)?,
            position,
        })
    }

    /// Returns the record of a row, or the reason why the row is not a record.
    fn understand(
        &self,
        fields: &[Cow<'_, str>],
        line: usize,
        station: Option<i64>,
        stamps: &mut Stamps,
    ) -> Result<RawRecord, String> {
        let in_column = |column: usize, name: &str, value: Result<f64, String>| {
            value.map_err(|what| format!("`{}` in column `{name}` {what}", shown(&fields[column])))
        };
        let mapping = self.mapping;
        let name = |name: &'m Option<String>| name.as_deref().unwrap_or_default();
        let station = match self.station {
            Some(column) => station_number(&fields[column]).ok_or_else(|| {
                let name = name(&mapping.station);
                format!("`{}` in column `{name}` is not a station number", shown(&fields[column]))
            })?,
            None => station.ok_or("no station column is given")?,
        };
        let decimal_comma = self.separator != ',';
        let status = match self.status {
            None => 0.0,
            Some(column) => {
                in_column(column, name(&mapping.status), number(&fields[column], decimal_comma))?
            }
        };
        let time_s = stamps.seconds(&fields[self.time], mapping, station, decimal_comma);
        let length = |column: usize, own: &'m Option<String>| {
            let value = metres(&fields[column], mapping.length_unit, decimal_comma);
            in_column(column, name(own), value)
        };
        let angle = |column: usize, own: &'m Option<String>| {
            let value = angle_rad(&fields[column], mapping.angle_unit, decimal_comma);
            in_column(column, name(own), value)
        };
        let polar = match self.position {
            PositionColumns::Cartesian([x, y, z]) => Polar::from_cartesian(
                [length(x, &mapping.x)?, length(y, &mapping.y)?, length(z, &mapping.z)?].into(),
            ),
            PositionColumns::Polar([range, azimuth, vertical]) => {
                let vertical_rad = angle(vertical, &mapping.vertical)?;
                Polar {
                    range_m: length(range, &mapping.range)?,
                    azimuth_rad: angle(azimuth, &mapping.azimuth)?,
                    zenith_rad: match mapping.vertical_angle {
                        VerticalAngle::Zenith => vertical_rad,
                        VerticalAngle::Elevation => std::f64::consts::FRAC_PI_2 - vertical_rad,
                    },
                }
            }
        };
        Ok(RawRecord {
            station,
            // A fraction that truncates to 0 is not a valid status.
            status: if status == 0.0 { 0 } else { (status as i64).max(1) },
            place: line,
            measurement: Measurement {
                time_s: in_column(self.time, &mapping.time, time_s)?,
                range_m: polar.range_m,
                azimuth_rad: polar.azimuth_rad,
                zenith_rad: polar.zenith_rad,
            },
            own_clock_s: None,
        })
    }

    /// Describes the meaning of the columns.
    fn said(&self) -> String {
        let ColumnMapping { time, range, azimuth, vertical, x, y, z, .. } = self.mapping;
        let position: Vec<_> = match self.position {
            PositionColumns::Polar(_) => [range, azimuth, vertical].into_iter().flatten().collect(),
            PositionColumns::Cartesian(_) => [x, y, z].into_iter().flatten().collect(),
        };
        let position: Vec<_> = position.into_iter().map(|name| shown(name)).collect();
        let how = match self.position {
            PositionColumns::Polar(_) => format!(
                "range ({}), azimuth and {} angle ({})",
                self.mapping.length_unit.words(),
                self.mapping.vertical_angle.words(),
                self.mapping.angle_unit.words()
            ),
            PositionColumns::Cartesian(_) => format!(
                "coordinates in the station's own frame ({}), which contain the prism constant",
                self.mapping.length_unit.words()
            ),
        };
        format!("columns {} are {how}; time is `{}`", position.join(", "), shown(time))
    }
}

#[cfg(test)]
mod tests;
