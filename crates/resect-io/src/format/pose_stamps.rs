//! Stamps of tables of poses: their columns, and the unit of their counts.

use std::borrow::Cow;

use super::column_units::{self, without_unit};
use super::gps_time::{clock_of_week_s, unix_from_gpst_s};
use super::joined_stamps::joined_s;
use super::mapped_csv::calendar_s;
use super::table::{self, number};
use resect_core::statistics::median;

/// Largest median interval between poses (s) of a unit of time that is guessed.
const LONGEST_INTERVAL_S: f64 = 100.0;

/// Columns of a stamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeColumns {
    /// One number or date; counts per second, if the header names the unit.
    One(usize, Option<u32>),
    SecondsAndNanoseconds(usize, usize),
    /// Date and time of day; true in GPS time, false in UTC.
    DateAndTime(usize, usize, bool),
    /// Week of GPS and its seconds.
    WeekAndSeconds(usize, usize),
    /// Date with time of day in GPS time.
    GpsCalendar(usize),
}

impl TimeColumns {
    /// Finds the columns by the names in a header; `None` if there are none.
    ///
    /// # Errors
    /// If the unit of the column of times is not read.
    pub fn named(headers: &[&str]) -> Result<Option<Self>, String> {
        let names: Vec<String> = headers.iter().map(|header| without_unit(header)).collect();
        let columns = Self::by_names(&|wanted| names.iter().position(|name| name == wanted));
        Ok(match columns {
            Some(Self::One(column, _)) => {
                Some(Self::One(column, column_units::counts_per_second(headers[column])?))
            }
            columns => columns,
        })
    }

    /// Finds the columns by their names without units, in lower case; the unit of one is not known yet.
    fn by_names(find: &dyn Fn(&str) -> Option<usize>) -> Option<Self> {
        // The stamp of a message precedes the time of its recording.
        const TIMES: [&str; 9] = [
            "header_stamp",
            "stamp",
            "timestamp",
            "time",
            "t",
            "timestamp_s",
            "time_s",
            "utime",
            "date",
        ];
        const PAIRS: [[&str; 2]; 5] = [
            ["header_stamp_sec", "header_stamp_nanosec"],
            ["header_stamp_secs", "header_stamp_nsecs"],
            ["sec", "nanosec"],
            ["sec", "nsec"],
            ["secs", "nsecs"],
        ];
        const UTC_TIMES: [&str; 4] = ["utc", "utc_time", "datetime", "unix_time"];
        const DATES: [([&str; 2], bool); 4] = [
            (["date", "time"], false),
            (["utc_date", "utc_time"], false),
            (["utcdate", "utctime"], false),
            (["gps_date", "gps_time"], true),
        ];
        const WEEKS: [&str; 3] = ["gps_week", "gpsweek", "week"];
        const OF_WEEK: [&str; 11] = [
            "gps_tow",
            "gps_sow",
            "gps_seconds",
            "gps_seconds_of_week",
            "gps_time_of_week",
            "gpsseconds",
            "gpstime",
            "tow",
            "sow",
            "seconds_of_week",
            "time_of_week",
        ];
        if let Some((sec, nsec)) = PAIRS.into_iter().find_map(|[s, ns]| find(s).zip(find(ns))) {
            return Some(Self::SecondsAndNanoseconds(sec, nsec));
        }
        let dated = DATES.into_iter().find_map(|([date, time], is_gpst)| {
            Some(Self::DateAndTime(find(date)?, find(time)?, is_gpst))
        });
        let single = |names: &[&str]| {
            let column = names.iter().find_map(|name| find(name))?;
            Some(Self::One(column, None))
        };
        let week = || WEEKS.into_iter().find_map(find).zip(OF_WEEK.into_iter().find_map(find));
        // A time of day belongs to its date.
        single(&TIMES[..3])
            .or(dated)
            .or_else(|| single(&TIMES[3..]))
            .or_else(|| single(&UTC_TIMES))
            .or_else(|| week().map(|(week, of_week)| Self::WeekAndSeconds(week, of_week)))
            .or_else(|| {
                ["gpst", "gps_time"].iter().find_map(|name| find(name)).map(Self::GpsCalendar)
            })
    }

    pub fn indices(self) -> Vec<usize> {
        match self {
            Self::One(column, _) | Self::GpsCalendar(column) => vec![column],
            Self::SecondsAndNanoseconds(first, second)
            | Self::DateAndTime(first, second, _)
            | Self::WeekAndSeconds(first, second) => vec![first, second],
        }
    }

    /// Returns the stamp in a row, or the reason why it is none.
    pub fn stamp(&self, fields: &[Cow<'_, str>], separator: char) -> Result<Stamp, String> {
        let field = |column: usize| {
            let field = fields.get(column).map(AsRef::as_ref);
            field.ok_or_else(|| format!("only {} fields", fields.len()))
        };
        let value = |column: usize| -> Result<f64, String> {
            let field = field(column)?;
            match number(field, separator != ',') {
                Ok(value) if value.is_finite() => Ok(value),
                _ => Err(format!("`{}` is not a number", table::shown(field))),
            }
        };
        let calendar = |text: &str| {
            calendar_s(text, 0.0).map_err(|what| format!("`{}` {what}", table::shown(text)))
        };
        Ok(match *self {
            Self::One(column, _) => stamp(field(column)?, separator)?,
            Self::SecondsAndNanoseconds(seconds, nanoseconds) => {
                Stamp::Seconds(value(seconds)? + 1e-9 * value(nanoseconds)?)
            }
            Self::DateAndTime(_, time, false) if number(field(time)?, false).is_ok() => {
                stamp(field(time)?, separator)?
            }
            Self::DateAndTime(date, time, is_gpst) => {
                let clock_s = calendar(&format!("{} {}", field(date)?, field(time)?))?;
                Stamp::Seconds(if is_gpst { unix_from_gpst_s(clock_s) } else { clock_s })
            }
            Self::WeekAndSeconds(week, of_week) => {
                let (week, of_week_s) = (value(week)?, value(of_week)?);
                let is_week = week.fract() == 0.0 && (0.0..=f64::from(u16::MAX)).contains(&week);
                let clock_s = clock_of_week_s(week as u16, of_week_s).filter(|_| is_week);
                let clock_s = clock_s.ok_or_else(|| {
                    format!("{week} and {of_week_s} are no week of GPS and its seconds")
                })?;
                Stamp::Seconds(unix_from_gpst_s(clock_s))
            }
            Self::GpsCalendar(column) => {
                Stamp::Seconds(unix_from_gpst_s(calendar(field(column)?)?))
            }
        })
    }
}

/// A stamp before its unit is known. Nanoseconds have more digits than a double.
#[derive(Clone, Copy, Debug)]
pub enum Stamp {
    Whole(i128),
    /// A number, and the same as if the digits behind the point were a count of nanoseconds.
    Real(f64, Option<f64>),
    Seconds(f64),
}

impl Stamp {
    fn value(self) -> f64 {
        match self {
            Self::Whole(whole) => whole as f64,
            Self::Real(value, _) | Self::Seconds(value) => value,
        }
    }

    fn seconds(self, per_second: u32) -> f64 {
        let unit = i128::from(per_second);
        match self {
            Self::Whole(whole) => {
                (whole / unit) as f64 + (whole % unit) as f64 / f64::from(per_second)
            }
            Self::Real(value, _) => value / f64::from(per_second),
            Self::Seconds(value) => value,
        }
    }
}

/// Returns the times of stamps in the order of a file (s), and true if seconds and nanoseconds were joined, which is corrected.
pub fn times_s(time: TimeColumns, mut stamps: Vec<Stamp>) -> (Vec<f64>, bool) {
    let are_joined = separate_joined_stamps(&mut stamps);
    let per_second = match time {
        TimeColumns::One(_, unit) => counts_per_second(&stamps, unit),
        TimeColumns::DateAndTime(..) => counts_per_second(&stamps, None),
        _ => 1,
    };
    (stamps.into_iter().map(|stamp| stamp.seconds(per_second)).collect(), are_joined)
}

/// Replaces stamps like 1760000000.42186 by 1760000000.000042186 if only that puts the poses in order; returns true if it did.
fn separate_joined_stamps(stamps: &mut [Stamp]) -> bool {
    let joined_s = |stamp: &Stamp| match stamp {
        Stamp::Real(_, joined_s) => *joined_s,
        _ => None,
    };
    let Some(separated_s) = stamps.iter().map(joined_s).collect::<Option<Vec<f64>>>() else {
        return false;
    };
    let is_ordered = stamps.is_sorted_by(|a, b| a.value() <= b.value());
    if is_ordered || !separated_s.is_sorted() {
        return false;
    }
    for (stamp, time_s) in stamps.iter_mut().zip(separated_s) {
        *stamp = Stamp::Seconds(time_s);
    }
    true
}

fn stamp(field: &str, separator: char) -> Result<Stamp, String> {
    if let Ok(whole) = field.parse::<i128>() {
        return Ok(Stamp::Whole(whole));
    }
    match number(field, separator != ',') {
        Ok(value) if value.is_finite() => Ok(Stamp::Real(value, joined_s(field))),
        // ISO 8601, in UTC unless it names an offset.
        _ => match calendar_s(field, 0.0) {
            Ok(time_s) => Ok(Stamp::Seconds(time_s)),
            Err(_) => Err(format!("`{}` is not a time", table::shown(field))),
        },
    }
}

/// Returns the counts per second of stamps: those that the header names, unless the stamps are too large for them; otherwise by the size
/// of stamps since 1970, if the interval between poses is possible.
fn counts_per_second(stamps: &[Stamp], named: Option<u32>) -> u32 {
    const UNITS: [(f64, u32); 4] =
        [(0.0, 1), (1e11, 1_000), (1e14, 1_000_000), (1e17, 1_000_000_000)];
    let size = median(stamps.iter().map(|stamp| stamp.value().abs())).unwrap_or(0.0);
    if let Some(named) = named.filter(|named| size / f64::from(*named) < UNITS[1].0) {
        return named;
    }
    let intervals = stamps.windows(2).map(|pair| (pair[1].value() - pair[0].value()).abs());
    let interval = median(intervals.filter(|interval| *interval > 0.0)).unwrap_or(0.0);
    let by_size = UNITS.into_iter().rposition(|(least, _)| size >= least).unwrap_or(0);
    // Stamps since the start of a computer are smaller than their unit suggests; seconds are never replaced.
    let is_possible = |(_, unit): &&(f64, u32)| interval / f64::from(*unit) < LONGEST_INTERVAL_S;
    match by_size {
        0 => 1,
        _ => UNITS[by_size..].iter().find(is_possible).map_or(UNITS[by_size].1, |(_, unit)| *unit),
    }
}
