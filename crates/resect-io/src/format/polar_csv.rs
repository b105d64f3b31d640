//! Polar measurements of all stations in one table: `timestamp,id,distance,ha,va`.
//!
//! Seconds, station number, metres without the prism constant, azimuth and zenith angle in radians.

use std::io::Read;

use super::table;
use crate::error::OpenError;
use crate::findings::tracks::rows_skipped;
use crate::recording::Recording;
use resect_core::deployment::ColumnMapping;
use resect_core::deployment::{Measurement, RawRecord};
use resect_core::progress::Progress;

pub const COLUMNS: [&str; 5] = ["timestamp", "id", "distance", "ha", "va"];

/// Reads all lines; only numbers are checked. `progress` counts bytes.
pub fn read(
    file: &str,
    reader: impl Read,
    progress: &Progress,
    into: &mut Recording,
) -> Result<(), OpenError> {
    into.begin_file(file, "line");
    let mut found = false;
    let skipped = table::for_each_row(file, reader, &COLUMNS, progress, |row| {
        let [time_s, _, range_m, azimuth_rad, zenith_rad] = row.values;
        let station = row.whole(1, COLUMNS[1])?;
        found = true;
        into.push(&RawRecord {
            station,
            status: 0,
            place: row.line,
            measurement: Measurement { time_s, range_m, azimuth_rad, zenith_rad },
            own_clock_s: None,
        });
        Ok(())
    })?;
    into.findings.extend(rows_skipped(file, &skipped));
    if found { Ok(()) } else { Err(no_measurement(file)) }
}

/// Adds the column names of this format to a mapping that has only units; returns any other mapping unchanged.
pub fn with_own_names(units: &ColumnMapping) -> ColumnMapping {
    let ColumnMapping { time, range, azimuth, vertical, x, y, z, .. } = units;
    if !time.is_empty() || [range, azimuth, vertical, x, y, z].iter().any(|name| name.is_some()) {
        return units.clone();
    }
    let [time, station, range, azimuth, vertical] = COLUMNS.map(str::to_owned);
    ColumnMapping {
        time,
        station: Some(station),
        range: Some(range),
        azimuth: Some(azimuth),
        vertical: Some(vertical),
        ..units.clone()
    }
}

/// The error of a table that has only a header.
pub(super) fn no_measurement(file: &str) -> OpenError {
    let what = "has a header but no measurement";
    OpenError::file(file, what, "record the deployment again")
}

/// Returns a text that [`read`] reads.
pub fn write(records: &[RawRecord]) -> String {
    let mut text = COLUMNS.join(",") + "\n";
    for RawRecord { station, measurement: m, .. } in records {
        text += &format!(
            "{:.6},{station},{:.5},{:.8},{:.8}\n",
            m.time_s, m.range_m, m.azimuth_rad, m.zenith_rad
        );
    }
    text
}
