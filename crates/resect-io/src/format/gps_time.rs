//! GPS time and UTC.

use jiff::civil::{Date, date};

/// Seconds of a week of GPS.
const WEEK_S: f64 = 7.0 * 86_400.0;

/// The first day of week 0 of GPS.
const GPS_WEEK_0: Date = date(1980, 1, 6);

/// Year and month that begin directly after a leap second, since GPS time and UTC agreed (IERS Bulletin C).
const LEAPS: [(i16, i8); 18] = [
    (1981, 7),
    (1982, 7),
    (1983, 7),
    (1985, 7),
    (1988, 1),
    (1990, 1),
    (1991, 1),
    (1992, 7),
    (1993, 7),
    (1994, 7),
    (1996, 1),
    (1997, 7),
    (1999, 1),
    (2006, 1),
    (2009, 1),
    (2012, 7),
    (2015, 7),
    (2017, 1),
];

/// Unix times of the leap seconds, each with the total number from then on.
fn leaps() -> impl Iterator<Item = (f64, f64)> {
    LEAPS
        .iter()
        .zip(1..)
        .map(|((year, month), n)| (unix_of_day_s(date(*year, *month, 1)), f64::from(n)))
}

/// Converts seconds from 1970 on a clock of GPS time to Unix time.
pub fn unix_from_gpst_s(gpst_s: f64) -> f64 {
    gpst_s - leaps().take_while(|(since_s, n)| since_s + n <= gpst_s).count() as f64
}

/// Converts Unix time to seconds from 1970 on a clock of GPS time.
pub fn gpst_from_unix_s(unix_s: f64) -> f64 {
    unix_s + leaps().take_while(|(since_s, _)| *since_s <= unix_s).count() as f64
}

/// Returns seconds from 1970 on the clock of a week of GPS and its seconds; `None` if the week has no such second.
pub fn clock_of_week_s(week: u16, of_week_s: f64) -> Option<f64> {
    let week_s = unix_of_day_s(GPS_WEEK_0) + f64::from(week) * WEEK_S;
    (0.0..WEEK_S).contains(&of_week_s).then_some(week_s + of_week_s)
}

/// Returns the seconds from 1970-01-01 to a date, with days of equal length.
pub fn unix_of_day_s(day: Date) -> f64 {
    day.duration_since(date(1970, 1, 1)).as_secs_f64()
}
