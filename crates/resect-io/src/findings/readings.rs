//! Findings about readings: impossible values, stamps, dropped records.

use crate::findings::kinds as file_kinds;
use resect_core::deployment::kinds;
use resect_core::deployment::{Finding, Subject, Unit};
use resect_core::network::PerStation;

/// `place` is the place of the first dropped record.
pub fn records_dropped(station: Option<usize>, reason: &str, count: usize, place: &str) -> Finding {
    let message = match station {
        Some(station) => format!("station {}: {reason}: {count} dropped ({place})", station + 1),
        None => format!("{reason}: {count} dropped ({place})"),
    };
    let subject = match station {
        Some(station) => Subject::OfStation { station, part: reason.to_owned() },
        None => Subject::Named(reason.to_owned()),
    };
    Finding::new(file_kinds::RECORDS_DROPPED, message).about(subject).count("records", count)
}

pub fn stamps_out_of_order(station: usize, count: usize, files: &str) -> Finding {
    Finding::new(
        file_kinds::STAMPS_OUT_OF_ORDER,
        format!(
            "station {}: {count} out-of-order stamps in {files}; the track was sorted by time",
            station + 1
        ),
    )
    .about(Subject::Station(station))
    .count("readings", count)
}

/// `first` is the place of the first one, as " (first at …)", or empty.
pub fn stamps_repeated(station: usize, count: usize, first: &str) -> Finding {
    let message = format!("station {}: {count} duplicate stamps dropped{first}", station + 1);
    Finding::new(file_kinds::STAMPS_REPEATED, message)
        .about(Subject::Station(station))
        .count("readings", count)
}

/// `others` are the numbers of the stations with readings: "[1, 3]".
pub fn station_without_readings(station: usize, files: &str, others: &str) -> Finding {
    Finding::new(
        file_kinds::STATION_WITHOUT_READINGS,
        format!(
            "station {} has no measurement in {files}; to calibrate without it, list the other stations in deployment.toml \
             (stations = {others})",
            station + 1
        ),
    )
    .about(Subject::Station(station))
}

/// `counts` are the numbers of impossible readings by reason.
pub fn readings_implausible(
    station: usize,
    impossible: usize,
    valid: usize,
    counts: &[(&str, usize)],
) -> Finding {
    let share = impossible as f64 / valid.max(1) as f64;
    let counts: Vec<_> =
        counts.iter().map(|(reason, count)| format!("{reason}: {count}")).collect();
    Finding::new(
        file_kinds::READINGS_IMPLAUSIBLE,
        format!(
            "station {}: {impossible} of {valid} readings marked as valid ({:.1} %) are impossible ({}): the recorder \
             marks invalid readings as valid, so the others may be wrong too",
            station + 1,
            100.0 * share,
            counts.join(", ")
        ),
    )
    .about(Subject::Station(station))
    .count("impossible", impossible)
    .count("readings", valid)
}

/// Converted to face left, `count` of `all` readings are used like the others.
pub fn readings_in_face_right(station: usize, count: usize, all: usize) -> Finding {
    let message = format!(
        "station {}: {count} of {all} readings are in face right and were converted to face left; vertical index and \
         collimation errors have the opposite sign there",
        station + 1
    );
    Finding::new(file_kinds::READINGS_IN_FACE_RIGHT, message)
        .about(Subject::Station(station))
        .count("readings", count)
}

/// `set_back_s` are the largest steps of the stations' stamps (s), 0 without one; returns `None` without any.
pub fn clock_set_back(set_back_s: &PerStation<f64>) -> Option<Finding> {
    let with_steps = set_back_s.each().filter(|(_, back_s)| **back_s > 0.0);
    let stations: Vec<usize> = with_steps.map(|(station, _)| station.number()).collect();
    let largest_s = set_back_s.iter().copied().fold(0.0, f64::max);
    let message = format!(
        "the stamps of {} go back by {largest_s:.1} s into a time that has other readings: the clock was set while \
         recording; leave out the readings near the step",
        station_list(&stations)
    );
    let finding =
        Finding::new(file_kinds::CLOCK_SET_BACK, message).quantity("back", largest_s, Unit::Second);
    (largest_s > 0.0).then_some(finding)
}

/// `stations` are indices, from 0.
pub fn stamps_coarse(stations: &[usize], resolution_s: f64) -> Finding {
    let numbers: Vec<usize> = stations.iter().map(|station| station + 1).collect();
    let list = station_list(&numbers);
    Finding::new(
        file_kinds::STAMPS_COARSE,
        format!(
            "the stamps of {list} are rounded to {resolution_s} s: a prism moves {:.1} m in that time at 1 m/s; record \
             them with more digits",
            resolution_s
        ),
    )
    .quantity("resolution", resolution_s, Unit::Second)
    .about(match stations {
        [one] => Subject::Station(*one),
        _ => Subject::Named(list),
    })
}

pub fn stamps_relative(first_s: f64) -> Finding {
    Finding::new(
        file_kinds::STAMPS_RELATIVE,
        format!(
            "stamps have an arbitrary start (the first is {first_s:.3} s) and cannot be compared with GNSS"
        ),
    )
    .quantity("first_stamp", first_s, Unit::Second)
}

/// `spans_s` are the spans of the readings of the two stations (from 0), in seconds.
pub fn stations_without_common_time(stations: [usize; 2], spans_s: [[f64; 2]; 2]) -> Finding {
    let [a, b] = stations.map(|station| station + 1);
    let [[a_from, a_to], [b_from, b_to]] = spans_s.map(|span| span.map(short_number));
    Finding::new(
        kinds::STATIONS_WITHOUT_COMMON_TIME,
        format!(
            "stations {a} and {b} never measured at the same time: {a_from} to {a_to} s, {b_from} to {b_to} s; their \
             clocks differ, or the tracks are of different drives"
        ),
    )
    .about(Subject::Named(format!("stations {a} and {b}")))
}

/// "station 2" or "stations 1, 3".
pub fn station_list(numbers: &[usize]) -> String {
    let list = numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    if numbers.len() == 1 { format!("station {list}") } else { format!("stations {list}") }
}

/// Formats a number with as many digits as a message needs.
pub fn short_number(value: f64) -> String {
    match value.abs() {
        size if size >= 1e11 => format!("{value:.3e}"),
        size if size >= 1e3 => format!("{value:.1}"),
        _ => format!("{value:.3}"),
    }
}

pub(super) fn examples() -> Vec<Finding> {
    vec![
        records_dropped(Some(1), "status 3", 12, "line 7 of drive.csv"),
        stamps_out_of_order(0, 3, "drive.csv"),
        stamps_repeated(2, 14, " (first at line 9 of drive.csv)"),
        station_without_readings(2, "drive.csv", "[1, 2]"),
        readings_implausible(0, 40, 400, &[("ranges of zero", 40)]),
        stamps_coarse(&[0, 2], 1.0),
        readings_in_face_right(1, 300, 900),
        clock_set_back(&[0.0, 3.0, 3.1].into()).expect("two stations"),
        stamps_relative(12.5),
        stations_without_common_time([0, 2], [[0.0, 60.0], [90.0, 150.0]]),
    ]
}
