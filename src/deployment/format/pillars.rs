//! Surveyed pillars along a straight line: `marker_number,distance_m,height_m`.

use nalgebra::Vector3;

use super::{OpenError, table};

pub const COLUMNS: [&str; 3] = ["marker_number", "distance_m", "height_m"];

/// Marker and coordinates (m) of each pillar: x along the line from the first, z up.
pub fn read(file: &str, text: &str) -> Result<Vec<(i64, Vector3<f64>)>, OpenError> {
    table::read_columns(file, text, &COLUMNS)?
        .iter()
        .map(|row| {
            let marker = row.whole(file, 0, COLUMNS[0])?;
            let position_m = Vector3::new(row.values[1], 0.0, row.values[2]);
            if position_m.iter().all(|value| value.is_finite()) {
                Ok((marker, position_m))
            } else {
                Err(OpenError::line(
                    file,
                    row.line,
                    "not a coordinate",
                    "correct or delete the line",
                ))
            }
        })
        .collect()
}
