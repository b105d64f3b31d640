//! Findings about the clocks of a recording, and about several drives.

use crate::deployment::kinds;
use crate::deployment::{Finding, Subject, Unit};
use crate::network::MOST_STATIONS;

pub fn stamps_are_station_clocks() -> Finding {
    Finding::new(
        kinds::STAMPS_ARE_STATION_CLOCKS,
        "the stamps of the readings are the stations' own clocks: the recording does not show if they were synchronised",
    )
}

/// A station's own clock minus the stamps.
#[derive(Clone, Copy)]
pub struct ClockDifference {
    /// The station, 0 to 2.
    pub station: usize,
    pub offset_s: f64,
    pub drift_ppm: f64,
    pub spread_s: f64,
}

pub fn station_clocks_compared(clocks: &[ClockDifference]) -> Finding {
    let in_words = |clock: &ClockDifference| {
        format!(
            "station {} {:+.4} s ({:+.1} ppm, ± {:.1} ms)",
            clock.station + 1,
            clock.offset_s,
            clock.drift_ppm,
            clock.spread_s * 1e3
        )
    };
    let each: Vec<String> = clocks.iter().map(in_words).collect();
    let message =
        format!("own clocks minus synchronised stamps (the stamps are used): {}", each.join(", "));
    const OFFSETS: [&str; MOST_STATIONS] = [
        "offset_station_1",
        "offset_station_2",
        "offset_station_3",
        "offset_station_4",
        "offset_station_5",
        "offset_station_6",
        "offset_station_7",
        "offset_station_8",
    ];
    clocks.iter().fold(Finding::new(kinds::STATION_CLOCKS_COMPARED, message), |found, clock| {
        found.quantity(OFFSETS[clock.station], clock.offset_s, Unit::Second)
    })
}

pub fn station_clock_drifts(station: usize, drift_ppm: f64) -> Finding {
    Finding::new(
        kinds::STATION_CLOCK_DRIFTS,
        format!(
            "station {}: its own clock and its stamps drift apart by {drift_ppm:+.0} ppm, more than clocks do; one of them was \
             adjusted during the recording",
            station + 1
        ),
    )
    .about(Subject::Station(station))
    .quantity("drift", drift_ppm * 1e-6, Unit::Ratio)
}

/// The first of `count` jumps, `after_s` after the start of the recording.
pub fn station_clock_jumps(station: usize, by_s: f64, after_s: f64, count: usize) -> Finding {
    let more = match count {
        1 => String::new(),
        count => format!(", and {} more times", count - 1),
    };
    Finding::new(
        kinds::STATION_CLOCK_JUMPS,
        format!(
            "station {}: own clock minus stamp jumps by {by_s:+.4} s at {after_s:.1} s{more}; one of the two clocks was set \
             during the recording",
            station + 1
        ),
    )
    .about(Subject::Station(station))
    .quantity("jump", by_s, Unit::Second)
    .quantity("after", after_s, Unit::Second)
    .count("jumps", count)
}

/// `off_s` is the difference between stamps and corrections; `None` if too few readings have both times.
pub fn time_corrections(station: usize, count: usize, off_s: Option<f64>) -> Finding {
    let from =
        off_s.map_or_else(String::new, |off_s| format!(", {:+.1} ms from its stamps", off_s * 1e3));
    let message = format!("station {}: {count} time corrections{from}", station + 1);
    let finding = Finding::new(kinds::TIME_CORRECTIONS, message)
        .about(Subject::Station(station))
        .count("corrections", count);
    match off_s {
        Some(off_s) => finding.quantity("difference", off_s, Unit::Second),
        None => finding,
    }
}

pub fn time_corrections_contradict_stamps(station: usize, count: usize, off_s: f64) -> Finding {
    Finding::new(
        kinds::TIME_CORRECTIONS_CONTRADICT_STAMPS,
        format!(
            "station {}: the stamps contradict the {count} time corrections in the recording: own clock minus stamp differs \
             from them by {off_s:+.4} s",
            station + 1
        ),
    )
    .about(Subject::Station(station))
    .quantity("difference", off_s, Unit::Second)
}

/// Comparison by the recorder's clock: stamps of the stations (0 to 2) relative to those of the first (s), the range of the
/// stamps (s), and the range of the stations' own clocks (s).
pub fn stamps_contradict_recorder(
    against_first_s: &[(usize, f64)],
    stamps_s: f64,
    own_s: f64,
) -> Finding {
    let each: Vec<String> = against_first_s
        .iter()
        .map(|(station, apart_s)| format!("station {} {apart_s:+.3} s", station + 1))
        .collect();
    let first = against_first_s.first().map_or(1, |(station, _)| station + 1);
    Finding::new(
        kinds::STAMPS_CONTRADICT_RECORDER,
        format!(
            "the synchronised stamps (header.stamp) of the stations look wrong: against the recorder's clock they differ by \
             {stamps_s:.3} s ({}, from station {first}); the stations' own clocks (theodolite_time) differ by only {own_s:.3} s",
            each.join(", ")
        ),
    )
    .quantity("stamps_range", stamps_s, Unit::Second)
    .quantity("own_clocks_range", own_s, Unit::Second)
}

pub fn drive_shifted(drive: &str, by_s: f64) -> Finding {
    Finding::new(
        kinds::DRIVE_SHIFTED,
        format!(
            "{drive}: its stamps overlap those of the previous drive; it was moved behind that one, {by_s:.0} s later \
             than stamped"
        ),
    )
    .about(Subject::Named(drive.to_owned()))
    .quantity("shift", by_s, Unit::Second)
}

/// `largest_m` is the largest difference from the distances of the `first` drive.
pub fn drive_distances_differ(drive: &str, first: &str, largest_m: f64) -> Finding {
    Finding::new(
        kinds::DRIVE_DISTANCES_DIFFER,
        format!(
            "{drive}: its inter-prism distances differ from those of {first} by up to {:.1} mm; the latter are used",
            largest_m * 1e3
        ),
    )
    .about(Subject::Named(drive.to_owned()))
    .quantity("difference", largest_m, Unit::Metre)
}

pub(super) fn examples() -> Vec<Finding> {
    let clock = ClockDifference { station: 1, offset_s: 0.2, drift_ppm: 12.0, spread_s: 0.001 };
    vec![
        stamps_are_station_clocks(),
        station_clocks_compared(&[clock]),
        station_clock_drifts(1, 240.0),
        station_clock_jumps(2, 0.3, 120.0, 2),
        time_corrections(0, 40, None),
        time_corrections(0, 40, Some(0.002)),
        time_corrections_contradict_stamps(2, 40, 0.3),
        stamps_contradict_recorder(&[(0, 0.0), (1, 0.3), (2, -0.2)], 0.5, 0.01),
        drive_shifted("evening", 400.0),
        drive_distances_differ("evening", "morning", 0.0008),
    ]
}
