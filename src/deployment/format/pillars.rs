//! Surveyed pillars along a straight line: `marker_number,distance_m,height_m`.

use super::{OpenError, table};

pub const COLUMNS: [&str; 3] = ["marker_number", "distance_m", "height_m"];

/// The numbers of the pillars. Their coordinates wait for the two-point resection; today the markers
/// tell which control-point file holds the pillars.
pub fn read_markers(file: &str, text: &str) -> Result<Vec<i64>, OpenError> {
    table::read_columns(file, text, &COLUMNS)?
        .iter()
        .map(|row| row.whole(file, 0, COLUMNS[0]))
        .collect()
}
