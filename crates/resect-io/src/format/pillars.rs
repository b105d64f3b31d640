//! Surveyed pillars along a straight line: `marker_number,distance_m,height_m`.

use nalgebra::Vector3;

use super::table;
use crate::error::OpenError;
use resect_core::deployment::ControlPointSet;

pub const COLUMNS: [&str; 3] = ["marker_number", "distance_m", "height_m"];

/// Reads marker and coordinates (m) of each pillar: x along the line from the first pillar, z up.
pub fn read(file: &str, text: &str) -> Result<Vec<(i64, Vector3<f64>)>, OpenError> {
    let mut seen = Vec::new();
    table::read_columns(file, text, &COLUMNS)?
        .iter()
        .map(|row| {
            let marker = row
                .whole(0, COLUMNS[0])
                .map_err(|what| OpenError::line(file, row.line, what, table::CORRECT))?;
            if seen.contains(&marker) {
                let what = format!("pillar {marker} is listed twice");
                return Err(OpenError::line(file, row.line, what, "keep one of the lines"));
            }
            seen.push(marker);
            let position_m = Vector3::new(row.values[1], 0.0, row.values[2]);
            if position_m.iter().all(|value| value.is_finite()) {
                Ok((marker, position_m))
            } else {
                Err(OpenError::line(file, row.line, "not a coordinate", table::CORRECT))
            }
        })
        .collect()
}

/// Returns a text that [`read`] reads, with the points whose coordinates are known.
pub fn write(set: &ControlPointSet) -> String {
    let mut text = COLUMNS.join(",") + "\n";
    for (marker, known_m) in set.points.iter().filter_map(|p| Some((p.marker, p.known_m?))) {
        text += &format!("{marker},{:.3},{:.3}\n", known_m.x, known_m.z);
    }
    text
}
