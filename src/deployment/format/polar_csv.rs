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
    rows.into_iter()
        .map(|row| {
            let [time_s, _, range_m, azimuth_rad, zenith_rad] = row.values[..] else {
                unreachable!("read_columns gives as many values as columns");
            };
            Ok(RawRecord {
                station: row.whole(file, 1, COLUMNS[1])?,
                status: 0,
                place: row.line,
                measurement: Measurement { time_s, range_m, azimuth_rad, zenith_rad },
            })
        })
        .collect()
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
