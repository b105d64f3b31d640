//! Findings about tracks as a whole: files, columns, prism constant, spans and masks, GNSS.

use crate::findings::kinds;
use crate::skipped_rows::SkippedRows;
use resect_core::deployment::{Finding, Subject, Unit};
use resect_core::network::PerStation;

const DAY_S: f64 = 86_400.0;
/// Leap seconds between GPS time and UTC since 2017.
const GPS_MINUS_UTC_S: f64 = 18.0;

pub fn file_unreadable(file: &str) -> Finding {
    Finding::new(
        kinds::FILE_UNREADABLE,
        format!(
            "{file}: cannot be read and was skipped; check its permissions if it belongs to the deployment"
        ),
    )
    .about(Subject::File(file.to_owned()))
}

/// A date in a folder's name that differs from the day of the readings.
pub struct OtherDate<'a> {
    pub folder: &'a str,
    /// The date in the name, formatted.
    pub date: &'a str,
    /// Days from the date to the first stamp.
    pub days: f64,
    /// Stations (0 to 2) whose stamps contradict the date.
    pub stations: &'a [usize],
}

pub fn folder_date_contradicts_stamps(other: &OtherDate<'_>) -> Finding {
    let OtherDate { folder, date, days, stations } = *other;
    let stations: Vec<String> = stations.iter().map(|station| (station + 1).to_string()).collect();
    Finding::new(
        kinds::FOLDER_DATE_CONTRADICTS_STAMPS,
        format!(
            "the folder name {folder} contradicts the stamps: those of station {} are {:.0} days {} {date}. Either \
             the name or the data is wrong; check that rig and control points are of the same day as the tracks",
            stations.join(", "),
            days.abs(),
            if days > 0.0 { "after" } else { "before" },
        ),
    )
    .quantity("days", days, Unit::Count)
}

/// Returns a finding about the rows of a table that are not valid; `None` without any.
pub fn rows_skipped(file: &str, skipped: &SkippedRows) -> Option<Finding> {
    let (line, reason) = skipped.first.as_ref()?;
    let rows = if skipped.count == 1 { "1 row is" } else { &format!("{} rows are", skipped.count) };
    let message = format!(
        "{file}: {rows} not valid and skipped (line {line}: {reason}); correct the file if they matter"
    );
    let finding = Finding::new(kinds::ROWS_SKIPPED, message);
    Some(finding.about(Subject::File(file.to_owned())).count("rows", skipped.count))
}

/// `numbers` are the numbers of stations 1, 2, … in the files.
pub fn stations_renumbered(numbers: &PerStation<i64>) -> Finding {
    let list = numbers.map(ToString::to_string).as_slice().join(", ");
    let stations = numbers.map_each(|station, _| station.to_string()).as_slice().join(", ");
    Finding::new(
        kinds::STATIONS_RENUMBERED,
        format!(
            "the files number the stations {list}: these are stations {stations}; if that is another order, set stations = \
             [{list}] in deployment.toml"
        ),
    )
}

/// A jump of the stamps between two parts of a recording.
pub struct ClockJump {
    /// Time from the last stamp before the jump to the first one behind (s).
    pub gap_s: f64,
    /// Readings that are used, and those that are not.
    pub used: usize,
    pub unused: usize,
}

pub fn stamps_jumped(jump: &ClockJump) -> Finding {
    let ClockJump { gap_s, used, unused } = *jump;
    Finding::new(
        kinds::STAMPS_JUMPED,
        format!(
            "the stamps jump by {:.1} days: the clock was set while recording, or the file has several drives. Only the \
             longest part is used ({used} readings); {unused} readings are not. Put the parts into separate files to use \
             them all",
            gap_s / DAY_S
        ),
    )
    .quantity("gap", gap_s, Unit::Second)
    .count("unused", unused)
}

/// `columns` describes the meaning of the columns.
pub fn table_columns(file: &str, columns: &str) -> Finding {
    Finding::new(kinds::TABLE_COLUMNS, format!("{file}: {columns}"))
        .about(Subject::File(file.to_owned()))
}

/// `clock` describes the source of the stamps.
pub fn table_clock(file: &str, clock: &str) -> Finding {
    Finding::new(
        kinds::TABLE_CLOCK,
        format!(
            "{file}: {clock}; ranges contain the prism constant set on the instrument (according to the program's \
             source; not tested with a real recording)"
        ),
    )
    .about(Subject::File(file.to_owned()))
}

/// `from` names the source of the constants.
pub fn prism_constant_added(constants_m: &[f64], from: &str, in_tracks: bool) -> Finding {
    let mm = |constant_m: &f64| format!("{:+.1}", constant_m * 1e3);
    let constants = match constants_m {
        [first_m, others @ ..] if others.iter().all(|other_m| other_m == first_m) => {
            mm(first_m) + " mm"
        }
        each => {
            let stations: Vec<String> = (1..=each.len()).map(|number| number.to_string()).collect();
            let each: Vec<String> = each.iter().map(mm).collect();
            format!("{} mm (stations {})", each.join(", "), stations.join(", "))
        }
    };
    let message = if in_tracks {
        format!(
            "prism constant of {from}, {constants}, added to ranges of control points and rig; the tracks contain it \
             already"
        )
    } else {
        format!("prism constant of {from}, {constants}, added to every range")
    };
    let finding = Finding::new(kinds::PRISM_CONSTANT_ADDED, message);
    let names = [
        "station_1",
        "station_2",
        "station_3",
        "station_4",
        "station_5",
        "station_6",
        "station_7",
        "station_8",
    ];
    names.into_iter().zip(constants_m).fold(finding, |finding, (name, constant_m)| {
        finding.quantity(name, *constant_m, Unit::Metre)
    })
}

pub fn span_selected(from_s: f64, to_s: f64) -> Finding {
    let message =
        format!("only the {:.1} s from {from_s:.3} to {to_s:.3} s are used", to_s - from_s);
    Finding::new(kinds::SPAN_SELECTED, message).quantity("from", from_s, Unit::Second).quantity(
        "to",
        to_s,
        Unit::Second,
    )
}

pub fn readings_masked(count: usize) -> Finding {
    let message = format!("{count} readings are left out by hand");
    Finding::new(kinds::READINGS_MASKED, message).count("readings", count)
}

pub fn masked_readings_missing(count: usize) -> Finding {
    let message =
        format!("{count} masked readings are not in the tracks: the mask was made for other data");
    Finding::new(kinds::MASKED_READINGS_MISSING, message).count("readings", count)
}

pub fn gnss_antennas_missing(files: usize) -> Finding {
    Finding::new(
        kinds::GNSS_ANTENNAS_MISSING,
        format!(
            "{files} GNSS solution file(s) left out: three antennas are needed; list them in deployment.toml: gnss = \
             [\"…\", \"…\", \"…\"]"
        ),
    )
    .count("files", files)
}

pub fn gnss_origins_differ() -> Finding {
    Finding::new(
        kinds::GNSS_ORIGINS_DIFFER,
        "the GNSS antennas are left out: some positions are Earth-centred, others relative to a base station; solve \
         all with the same settings",
    )
}

pub fn gnss_stamps_out_of_order(file: &str, count: usize) -> Finding {
    let message = format!("{count} out-of-order stamps in {file}; the fixes were sorted by time");
    Finding::new(kinds::GNSS_STAMPS_OUT_OF_ORDER, message)
        .about(Subject::File(file.to_owned()))
        .count("fixes", count)
}

/// `line` is the line of the first one.
pub fn gnss_stamps_repeated(file: &str, count: usize, line: usize) -> Finding {
    let message = format!("{count} duplicate stamps dropped (first at line {line} of {file})");
    Finding::new(kinds::GNSS_STAMPS_REPEATED, message)
        .about(Subject::File(file.to_owned()))
        .count("fixes", count)
}

/// `station` is 0 to 2; `ranges_m` are the distances of nearly all positions from its origin.
pub fn cartesian_origin_doubtful(station: usize, ranges_m: [f64; 2], extent_m: f64) -> Finding {
    let [near_m, far_m] = ranges_m;
    let message = format!(
        "the positions of station {} lie {near_m:.0} to {far_m:.0} m from its origin and span only {extent_m:.0} m: if \
         coordinates of the set-up were added to them, subtract these, because errors of ranges and angles depend on the \
         distance",
        station + 1
    );
    Finding::new(kinds::CARTESIAN_ORIGIN_DOUBTFUL, message)
        .about(Subject::Station(station))
        .quantity("nearest", near_m, Unit::Metre)
        .quantity("extent", extent_m, Unit::Metre)
}

/// `station` is 0 to 2; `first_s` is the stamp of the first reading whose range was repeated.
pub fn ranges_repeated(station: usize, count: usize, first_s: f64) -> Finding {
    let message = format!(
        "station {} repeated an old range in {count} readings while its prism moved, first after {first_s:.2} s; these \
         readings are left out",
        station + 1
    );
    Finding::new(kinds::RANGES_REPEATED, message)
        .about(Subject::Station(station))
        .count("readings", count)
}

/// `station` is 0 to 2; its stamps are `ahead_s` (to a third of a second) later than those of the others for the same motion.
pub fn station_clock_off(station: usize, ahead_s: f64) -> Finding {
    let size_s = ahead_s.abs();
    let (later, cause) = (
        if ahead_s > 0.0 { "later" } else { "earlier" },
        if (size_s - GPS_MINUS_UTC_S).abs() < 0.5 {
            " (GPS time is 18 s ahead of UTC)"
        } else {
            ""
        },
    );
    let message = format!(
        "the stamps of station {} are about {size_s:.0} s {later} than those of the others{cause}: its speeds match theirs only \
         then; correct its stamps",
        station + 1
    );
    Finding::new(kinds::STATION_CLOCK_OFF, message).about(Subject::Station(station)).quantity(
        "ahead",
        ahead_s,
        Unit::Second,
    )
}

pub(super) fn examples() -> Vec<Finding> {
    let other =
        OtherDate { folder: "20220711", date: "2022-07-11", days: -3.0, stations: &[0, 1, 2] };
    vec![
        file_unreadable("old.csv"),
        folder_date_contradicts_stamps(&other),
        rows_skipped(
            "tracks.csv",
            &SkippedRows {
                count: 3,
                first: Some((7, "`x` in column `ha` is not a number".to_owned())),
            },
        )
        .expect("rows"),
        stations_renumbered(&[0, 1, 2].into()),
        stamps_jumped(&ClockJump { gap_s: 40.0 * DAY_S, used: 2790, unused: 206 }),
        table_columns("tracks.csv", "columns `r`, `hz`, `v` are range (metres)"),
        table_clock("tracks.csv", "stamps are ref_time, the time of arrival"),
        prism_constant_added(&[0.01; 3], "deployment.toml", false),
        cartesian_origin_doubtful(1, [242.0, 288.0], 46.0),
        ranges_repeated(1, 40, 1_657_569_010.25),
        station_clock_off(2, 18.0),
        span_selected(10.0, 70.0),
        readings_masked(3),
        masked_readings_missing(1),
        gnss_antennas_missing(2),
        gnss_origins_differ(),
        gnss_stamps_out_of_order("gnss1.pos", 2),
        gnss_stamps_repeated("gnss1.pos", 2, 40),
    ]
}
