//! Polar measurements of all stations in one table: `timestamp,id,distance,ha,va`.
//!
//! Seconds, station number, metres without the prism constant, azimuth and zenith angle in radians.

use super::{OpenError, table};
use crate::deployment::{Measurement, RawRecord};

pub const COLUMNS: [&str; 5] = ["timestamp", "id", "distance", "ha", "va"];

/// Every line, unchecked but for being numbers.
pub fn read(file: &str, text: &str) -> Result<Vec<RawRecord>, OpenError> {
    let rows = table::read_columns(file, text, &COLUMNS)?;
    if rows.is_empty() {
        return Err(OpenError::file(
            file,
            "has a header but no measurement",
            "record the deployment again",
        ));
    }
    Ok(rows
        .into_iter()
        .map(|row| RawRecord {
            station: row.values[1] as i64,
            status: 0,
            place: row.line,
            measurement: Measurement {
                time_s: row.values[0],
                range_m: row.values[2],
                azimuth_rad: row.values[3],
                zenith_rad: row.values[4],
            },
        })
        .collect())
}

/// The text that [`read`] reads.
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
