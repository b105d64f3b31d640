//! Polar measurements of all stations in one table: `timestamp,id,distance,ha,va`.
//!
//! Seconds, station number, metres without the prism constant, azimuth and zenith angle in radians.

use super::{OpenError, table};
use crate::deployment::{Measurement, RawRecord};
use crate::progress::Progress;

pub const COLUMNS: [&str; 5] = ["timestamp", "id", "distance", "ha", "va"];

const BYTES_BETWEEN_REPORTS: u64 = 1 << 16;

/// Every line, unchecked but for being numbers. `progress` counts its bytes.
pub fn read(file: &str, text: &str, progress: &Progress) -> Result<Vec<RawRecord>, OpenError> {
    let mut records = Vec::new();
    let mut counted = 0;
    for row in table::rows(file, text, &COLUMNS)? {
        let row = row?;
        let [time_s, _, range_m, azimuth_rad, zenith_rad] = row.values[..] else {
            unreachable!("rows have as many values as columns");
        };
        records.push(RawRecord {
            station: row.whole(file, 1, COLUMNS[1])?,
            status: 0,
            place: row.line,
            measurement: Measurement { time_s, range_m, azimuth_rad, zenith_rad },
        });
        if row.start_byte - counted > BYTES_BETWEEN_REPORTS {
            progress.advance(row.start_byte - counted)?;
            counted = row.start_byte;
        }
    }
    progress.advance(text.len() as u64 - counted)?;
    if records.is_empty() {
        return Err(OpenError::file(
            file,
            "has a header but no measurement",
            "record the deployment again",
        ));
    }
    Ok(records)
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
