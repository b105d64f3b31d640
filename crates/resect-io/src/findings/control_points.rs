//! Findings about control points, pillars and known coordinates.

use crate::findings::kinds;
use resect_core::deployment::{Finding, FindingKind, Subject};

/// A reading in a file of control points. `number` is the station's number in the file.
pub struct ReadingPlace<'a> {
    pub file: &'a str,
    pub line: usize,
    pub marker: i64,
    pub number: i64,
}

impl ReadingPlace<'_> {
    fn finding(&self, kind: FindingKind, message: &str) -> Finding {
        Finding::new(kind, format!("{}:{}: {message}", self.file, self.line))
            .about(Subject::Point { file: self.file.to_owned(), marker: self.marker })
    }
}

pub fn control_point_station_unknown(place: &ReadingPlace<'_>) -> Finding {
    let message = format!("station {} left out; stations are numbered from 1 to 8", place.number);
    place.finding(kinds::CONTROL_POINT_STATION_UNKNOWN, &message)
}

pub fn control_point_status_invalid(place: &ReadingPlace<'_>, status: f64) -> Finding {
    let ReadingPlace { marker, number, .. } = place;
    let message =
        format!("marker {marker} of station {number} left out: status {status} (no valid reading)");
    place.finding(kinds::CONTROL_POINT_STATUS_INVALID, &message)
}

pub fn control_point_reading_implausible(place: &ReadingPlace<'_>) -> Finding {
    let ReadingPlace { marker, number, .. } = place;
    let message = format!("marker {marker} of station {number} left out: not a usable reading");
    place.finding(kinds::CONTROL_POINT_READING_IMPLAUSIBLE, &message)
}

pub fn control_point_repeated(place: &ReadingPlace<'_>) -> Finding {
    let ReadingPlace { marker, number, .. } = place;
    let message =
        format!("marker {marker} of station {number} is repeated; the first reading is used");
    place.finding(kinds::CONTROL_POINT_REPEATED, &message)
}

pub fn control_points_empty(file: &str) -> Finding {
    Finding::new(kinds::CONTROL_POINTS_EMPTY, format!("{file}: no usable control point"))
        .about(Subject::File(file.to_owned()))
}

pub fn pillar_coordinates_unknown(file: &str, marker: i64) -> Finding {
    Finding::new(
        kinds::PILLAR_COORDINATES_UNKNOWN,
        format!(
            "{file}: coordinates of pillar {marker} are unknown: no survey of pillars contains it"
        ),
    )
    .about(Subject::Point { file: file.to_owned(), marker })
}

pub fn pillars_without_readings() -> Finding {
    Finding::new(
        kinds::PILLARS_WITHOUT_READINGS,
        "the survey of pillars has no file of readings, so all points are read as control points; rename the file \
         with the pillars' readings to Two_points.txt",
    )
}

/// `file` has the coordinates; `readings` lacks the readings.
pub fn known_point_not_measured(file: &str, readings: &str, marker: i64) -> Finding {
    Finding::new(
        kinds::KNOWN_POINT_NOT_MEASURED,
        format!("{file}: marker {marker} has no reading in {readings}"),
    )
    .about(Subject::Point { file: readings.to_owned(), marker })
}

pub(super) fn examples() -> Vec<Finding> {
    let place = ReadingPlace { file: "GCP.txt", line: 4, marker: 3, number: 2 };
    vec![
        control_point_station_unknown(&ReadingPlace { number: 9, ..place }),
        control_point_status_invalid(&place, 5.0),
        control_point_reading_implausible(&place),
        control_point_repeated(&place),
        control_points_empty("GCP.txt"),
        pillar_coordinates_unknown("Two_points.txt", 2),
        pillars_without_readings(),
        known_point_not_measured("known.csv", "GCP.txt", 9),
    ]
}
