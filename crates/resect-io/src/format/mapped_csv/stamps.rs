//! Stamps of other programs' tables, in seconds.

use jiff::civil::{Date, DateTime, Time};
use jiff::tz::{Offset, TimeZone};

use crate::format::table::{number, with_point};
use resect_core::deployment::ColumnMapping;
use resect_core::deployment::TimeFormat;

const DAY_S: f64 = 86_400.0;

/// Converts stamps one after the other, and counts midnights by station.
#[derive(Debug, Default)]
pub struct Stamps {
    /// Station, its last time of day with the days added, and the added days (s).
    days: Vec<(i64, f64, f64)>,
}

impl Stamps {
    /// Returns the stamp in seconds: Unix time for a calendar, since the first midnight for a time of day, otherwise as counted. The
    /// error completes a sentence that begins with the field.
    pub fn seconds(
        &mut self,
        field: &str,
        mapping: &ColumnMapping,
        station: i64,
        decimal_comma: bool,
    ) -> Result<f64, String> {
        let counted = |per_second: f64| {
            let value = number(field, decimal_comma)?;
            if value.is_nan() { Err("is not a time".to_owned()) } else { Ok(value / per_second) }
        };
        match mapping.time_format {
            TimeFormat::Seconds => counted(1.0),
            TimeFormat::Milliseconds => counted(1e3),
            TimeFormat::Microseconds => counted(1e6),
            TimeFormat::Nanoseconds => counted(1e9),
            TimeFormat::Calendar => {
                calendar_s(&with_point(field, decimal_comma), mapping.utc_offset_hours)
            }
            TimeFormat::TimeOfDay => {
                let time_s = time_of_day_s(&with_point(field, decimal_comma))?;
                Ok(self.after_midnight(time_s, station))
            }
        }
    }

    /// Adds a day if a time of day is more than half a day before the last one.
    fn after_midnight(&mut self, time_s: f64, station: i64) -> f64 {
        let known = self.days.iter().position(|(own, _, _)| *own == station);
        let index = known.unwrap_or_else(|| {
            self.days.push((station, time_s, 0.0));
            self.days.len() - 1
        });
        let (_, last_s, days_s) = &mut self.days[index];
        if time_s + *days_s < *last_s - DAY_S / 2.0 {
            *days_s += DAY_S;
        }
        *last_s = time_s + *days_s;
        *last_s
    }
}

/// Returns Unix seconds of a date and a time of day: ISO 8601, also with a space or slashes, or with the day first and points.
pub fn calendar_s(field: &str, utc_offset_hours: f64) -> Result<f64, String> {
    let field = field.trim();
    let what = || "is not a date and time".to_owned();
    if let Ok(stamp) = field.parse::<jiff::Timestamp>() {
        return Ok(seconds_of(stamp));
    }
    let (date, time) = field.split_once(['T', ' ']).ok_or_else(what)?;
    let date = date_of(date).ok_or_else(what)?;
    let time: Time = time.trim().parse().map_err(|_| what())?;
    let offset = Offset::from_seconds((utc_offset_hours * 3600.0).round() as i32)
        .map_err(|_| "cannot be converted: utc_offset_hours is not a valid time zone".to_owned())?;
    let zoned = DateTime::from_parts(date, time).to_zoned(TimeZone::fixed(offset));
    zoned.map(|zoned| seconds_of(zoned.timestamp())).map_err(|_| what())
}

/// Parses `2022-07-11`, `2022/07/11` or `11.07.2022`.
fn date_of(text: &str) -> Option<Date> {
    let parts: Vec<i16> =
        text.split(['-', '/', '.']).map(str::parse).collect::<Result<_, _>>().ok()?;
    let [first, month, last] = parts[..] else { return None };
    // Dates with slashes and the year last are refused: the month cannot be distinguished from the day.
    let (year, day) = match text.split(['-', '/', '.']).next()?.len() {
        4 => (first, last),
        _ if text.contains('.') => (last, first),
        _ => return None,
    };
    Date::new(year, i8::try_from(month).ok()?, i8::try_from(day).ok()?).ok()
}

fn seconds_of(stamp: jiff::Timestamp) -> f64 {
    stamp.as_second() as f64 + f64::from(stamp.subsec_nanosecond()) * 1e-9
}

/// Returns seconds since midnight of `19:50:01.135`.
fn time_of_day_s(field: &str) -> Result<f64, String> {
    let time: Time = field.trim().parse().map_err(|_| "is not a time of day".to_owned())?;
    let since = f64::from(time.hour()) * 3600.0 + f64::from(time.minute()) * 60.0;
    Ok(since + f64::from(time.second()) + f64::from(time.subsec_nanosecond()) * 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(field: &str, time_format: TimeFormat, utc_offset_hours: f64) -> Result<f64, String> {
        let mapping = ColumnMapping { time_format, utc_offset_hours, ..ColumnMapping::default() };
        Stamps::default().seconds(field, &mapping, 1, true)
    }

    #[test]
    fn every_way_to_write_a_moment_is_the_same_moment() {
        let expected = 1_657_569_001.135;
        for (field, format, offset) in [
            ("1657569001.135", TimeFormat::Seconds, 0.0),
            ("1657569001,135", TimeFormat::Seconds, 0.0),
            ("1657569001135", TimeFormat::Milliseconds, 0.0),
            ("1657569001135000", TimeFormat::Microseconds, 0.0),
            ("1657569001135000000", TimeFormat::Nanoseconds, 0.0),
            ("2022-07-11T19:50:01.135Z", TimeFormat::Calendar, 5.0),
            ("2022-07-11T15:50:01.135-04:00", TimeFormat::Calendar, 0.0),
            ("2022-07-11 15:50:01.135", TimeFormat::Calendar, -4.0),
            ("2022/07/11 19:50:01.135", TimeFormat::Calendar, 0.0),
            ("11.07.2022 19:50:01,135", TimeFormat::Calendar, 0.0),
        ] {
            let found = read(field, format, offset).expect(field);
            assert!((found - expected).abs() < 1e-6, "{field}: {found}");
        }
        for (field, format) in [
            ("yesterday", TimeFormat::Calendar),
            ("2022-13-11T19:50:01Z", TimeFormat::Calendar),
            ("07/11/2022 19:50:01", TimeFormat::Calendar),
            ("25:00:00", TimeFormat::TimeOfDay),
            ("", TimeFormat::Seconds),
        ] {
            assert!(read(field, format, 0.0).is_err(), "{field}");
        }
    }

    #[test]
    fn midnight_passes_for_each_station_alone() {
        let mapping =
            ColumnMapping { time_format: TimeFormat::TimeOfDay, ..ColumnMapping::default() };
        let mut stamps = Stamps::default();
        let mut read =
            |field, station| stamps.seconds(field, &mapping, station, false).expect(field);
        assert_eq!(read("23:59:59.5", 1), 86_399.5);
        assert_eq!(read("00:00:00.5", 1), 86_400.5);
        assert_eq!(read("23:59:59.75", 2), 86_399.75);
        assert_eq!(read("00:00:01", 2), 86_401.0);
        assert_eq!(read("00:00:02", 1), 86_402.0);
    }
}
