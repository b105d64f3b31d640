//! Comparison of the stamps of tracks with the date in the folder's name.

use crate::findings::tracks::{OtherDate, folder_date_contradicts_stamps};
use jiff::civil::{Date, date};

use resect_core::deployment::{Finding, Track};
use resect_core::network::PerStation;

const DAY_S: f64 = 86_400.0;
/// Tolerance (days): names are local dates, stamps UTC, and a drive may continue past midnight.
const TOLERANCE_DAYS: f64 = 1.0;
/// Earliest stamp that counts from 1970 (s): 2001. Earlier stamps count from another start.
const EARLIEST_STAMP_S: f64 = 978_307_200.0;

/// Returns a finding if a station's stamps differ by more than a day from the date in the folder's name. The folder then contains
/// other data than its name states, and the rig and control points may be of another day as well.
pub fn contradicts_folder(name: &str, tracks: &PerStation<Track>) -> Option<Finding> {
    let day = date_in(name)?;
    let day_s = day.duration_since(date(1970, 1, 1)).as_secs_f64();
    let off: Vec<(usize, f64)> = tracks
        .iter()
        .enumerate()
        .filter_map(|(station, track)| {
            let start_s = track.measurements.first().map(|m| m.time_s)?;
            let days = (start_s - day_s) / DAY_S;
            // The day lasts from its midnight to the next; the tolerance applies on both sides.
            let inside = (-TOLERANCE_DAYS..=1.0 + TOLERANCE_DAYS).contains(&days);
            (start_s > EARLIEST_STAMP_S && !inside).then_some((station, days.floor()))
        })
        .collect();
    let (_, days) = *off.first()?;
    let stations: Vec<usize> = off.iter().map(|(station, _)| *station).collect();
    let date = day.to_string();
    let other = OtherDate { folder: name, date: &date, days, stations: &stations };
    Some(folder_date_contradicts_stamps(&other))
}

/// Returns the date `20220711` or `2022-07-11` in a name.
fn date_in(name: &str) -> Option<Date> {
    let bytes = name.as_bytes();
    let digits = |at: usize, n: usize| -> Option<i64> {
        let part = bytes.get(at..at + n)?;
        part.iter()
            .all(u8::is_ascii_digit)
            .then(|| part.iter().fold(0, |value, digit| 10 * value + i64::from(digit - b'0')))
    };
    let is_digit = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
    (0..bytes.len()).find_map(|start| {
        if start > 0 && is_digit(start - 1) {
            return None;
        }
        let year = digits(start, 4).filter(|year| (2001..2100).contains(year))?;
        let apart = usize::from(matches!(bytes.get(start + 4), Some(b'-' | b'_' | b'.')));
        let month = digits(start + 4 + apart, 2).filter(|month| (1..=12).contains(month))?;
        let at = start + 6 + apart;
        let apart_again = usize::from(apart == 1 && bytes.get(at) == bytes.get(start + 4));
        let day = digits(at + apart_again, 2).filter(|day| (1..=31).contains(day))?;
        let ends = apart == apart_again && !is_digit(at + apart_again + 2);
        if ends { Date::new(year as i16, month as i8, day as i8).ok() } else { None }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::deployment::Measurement;

    #[test]
    fn dates_are_found_in_names() {
        for (name, expected) in [
            ("20220711-2", Some("2022-07-11")),
            ("2022-07-11-2-published", Some("2022-07-11")),
            ("run_2022_07_11", Some("2022-07-11")),
            ("20221301", None),
            ("20220230", None),
            ("120220711", None),
            ("202207110", None),
            ("2022-0711", None),
            ("warthog", None),
            ("été 20220711", Some("2022-07-11")),
        ] {
            let found = date_in(name).map(|day| day.to_string());
            assert_eq!(found.as_deref(), expected, "{name}");
        }
        assert_eq!(date_in("19700101"), None);
    }

    #[test]
    fn stamps_of_another_day_are_a_doubt() {
        let tracks = |start_s: f64| {
            let m =
                Measurement { time_s: start_s, range_m: 1.0, azimuth_rad: 0.0, zenith_rad: 1.5 };
            let track = Track { measurements: vec![m], ..Track::default() };
            PerStation::repeat(3, track)
        };
        let on_the_day_s = 1657569001.0;
        for (start_s, fine) in [
            (on_the_day_s, true),
            (on_the_day_s + DAY_S, true),
            (on_the_day_s - 1.5 * DAY_S, true),
            (on_the_day_s - 3.0 * DAY_S, false),
            (on_the_day_s + 30.0 * DAY_S, false),
            (12.5, true),
        ] {
            let found = contradicts_folder("20220711-2", &tracks(start_s));
            assert_eq!(found.is_none(), fine, "{start_s}: {found:?}");
            assert!(found.is_none_or(|f| f.to_string().contains("station 1, 2, 3")));
        }
    }
}
