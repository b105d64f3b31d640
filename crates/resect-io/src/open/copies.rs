//! Copies of a recording in one folder: a second download, a bag beside its compressed or converted form.

use super::found::FoundFile;
use crate::error::OpenError;
use resect_core::deployment::{Measurement, Track};
use resect_core::network::PerStation;

/// Largest difference of stamps of one reading (s): text files round them to microseconds.
pub const SAME_STAMP_S: f64 = 2e-6;
/// Largest difference of an angle (rad) and of a range (m) of a reading and of its copy, whose digits may be rounded.
const SAME_ANGLE_RAD: f64 = 1e-6;
const SAME_RANGE_M: f64 = 1e-5;

/// Returns true if all files contain the same readings.
///
/// # Errors
/// If the reading is cancelled. A file that cannot be read is no copy.
pub fn are_copies(
    candidates: &[&FoundFile],
    read: impl Fn(&FoundFile) -> Result<PerStation<Track>, OpenError>,
) -> Result<bool, OpenError> {
    let mut first: Option<PerStation<Track>> = None;
    for file in candidates {
        let tracks = match read(file) {
            Ok(tracks) => tracks,
            Err(OpenError::Cancelled) => return Err(OpenError::Cancelled),
            Err(_) => return Ok(false),
        };
        let first = first.get_or_insert_with(|| tracks.clone());
        if !first.iter().zip(&tracks).all(|(a, b)| are_equal(a, b)) {
            return Ok(false);
        }
    }
    Ok(true)
}

fn are_equal(a: &Track, b: &Track) -> bool {
    let is_same = |(a, b): (&Measurement, &Measurement)| {
        (a.time_s - b.time_s).abs() <= SAME_STAMP_S
            && (a.range_m - b.range_m).abs() <= SAME_RANGE_M
            && (a.azimuth_rad - b.azimuth_rad).abs() <= SAME_ANGLE_RAD
            && (a.zenith_rad - b.zenith_rad).abs() <= SAME_ANGLE_RAD
    };
    a.measurements.len() == b.measurements.len()
        && a.measurements.iter().zip(&b.measurements).all(is_same)
}
