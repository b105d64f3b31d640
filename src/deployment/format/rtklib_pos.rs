//! GNSS solutions as RTKLIB and Emlid write them (`.pos`): one fix a line, below `%` lines that describe them.
//!
//! "Positioning solution file" in appendix B.1 of the RTKLIB manual 2.4.2, and where it is silent `outsolheads` and
//! `outsols` of RTKLIB's `solution.c`: the `%` line with the columns begins with the time scale, then come three
//! coordinates and the quality. The user chooses the scale, the coordinates and the separator; a stamp is a date
//! and a time of day or a week and its seconds, both in the scale that the header names.
//!
//! Heights may be above the ellipsoid or the sea. They are taken for the former: between antennas of one vehicle
//! the difference is a few parts in a million of their distance.

use nalgebra::Vector3;

use super::OpenError;
use crate::deployment::{Finding, GnssFix};
use crate::geometry::Geodetic;

/// The largest quality that RTKLIB knows (`MAXSOLQ`).
const LARGEST_QUALITY: f64 = 7.0;

#[derive(Clone, Copy, Debug, PartialEq)]
enum TimeScale {
    Gpst,
    Utc,
    Jst,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Coordinates {
    /// Latitude, longitude (degrees), height (m).
    Degrees,
    /// Latitude, longitude (degrees, minutes and seconds as fields of their own), height (m).
    DegreesMinutesSeconds,
    /// Metres: ECEF, or east, north, up of the base.
    Cartesian,
}

/// What the line that names the columns says.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Layout {
    time_scale: TimeScale,
    coordinates: Coordinates,
    /// Fields of every line.
    fields: usize,
}

impl Layout {
    fn of(line: &str) -> Option<Self> {
        let names: Vec<_> = split(line.strip_prefix('%')?).collect();
        let time_scale = match *names.first()? {
            "GPST" => TimeScale::Gpst,
            "UTC" => TimeScale::Utc,
            "JST" => TimeScale::Jst,
            _ => return None,
        };
        let coordinates = match names.get(1..5)? {
            ["latitude(deg)", "longitude(deg)", "height(m)", "Q"] => Coordinates::Degrees,
            ["latitude(d'\")", "longitude(d'\")", "height(m)", "Q"] => {
                Coordinates::DegreesMinutesSeconds
            }
            ["x-ecef(m)", "y-ecef(m)", "z-ecef(m)", "Q"]
            | ["e-baseline(m)", "n-baseline(m)", "u-baseline(m)", "Q"] => Coordinates::Cartesian,
            _ => return None,
        };
        // A stamp is one column of two fields, and an angle in degrees, minutes and seconds one of three.
        let fields = names.len() + 1 + coordinates.fields() - 3;
        Some(Self { time_scale, coordinates, fields })
    }
}

impl Coordinates {
    fn fields(self) -> usize {
        if self == Self::DegreesMinutesSeconds { 7 } else { 3 }
    }

    /// The position (m) of as many numbers as there are fields.
    fn position_m(self, numbers: &[f64]) -> Option<Vector3<f64>> {
        let (latitude_deg, longitude_deg, height_m) = match (self, numbers) {
            (Self::Cartesian, [x, y, z]) => return Some(Vector3::new(*x, *y, *z)),
            (Self::Degrees, [latitude, longitude, height]) => (*latitude, *longitude, *height),
            (Self::DegreesMinutesSeconds, [d, m, s, e, n, t, height]) => {
                (degrees(*d, *m, *s), degrees(*e, *n, *t), *height)
            }
            _ => unreachable!("there are as many numbers as fields"),
        };
        let on_earth = latitude_deg.abs() <= 90.0 && longitude_deg.abs() <= 360.0;
        on_earth.then(|| {
            let latitude_rad = latitude_deg.to_radians();
            let longitude_rad = longitude_deg.to_radians();
            Geodetic { latitude_rad, longitude_rad, height_m }.to_ecef()
        })
    }
}

/// The sign stands before the degrees, also where they are "-0".
fn degrees(degrees: f64, minutes: f64, seconds: f64) -> f64 {
    (degrees.abs() + minutes / 60.0 + seconds / 3600.0).copysign(degrees)
}

/// Fields of a line, whichever separator the user chose; spaces pad the columns with all of them.
fn split(line: &str) -> impl Iterator<Item = &str> {
    line.split([' ', '\t', ',', ';']).filter(|field| !field.is_empty())
}

/// Whether this is the beginning of a solution file, which may end before the line that names the columns.
pub fn looks_like(head: &str) -> bool {
    // What RTKPOST writes first of all: the program, or nothing before the legend where the user wants it short.
    let starts =
        ["program   :", "inp file  :", "(lat/lon/height=", "(x/y/z-ecef=", "(e/n/u-baseline="];
    head.lines()
        .filter(|line| !line.trim().is_empty())
        .map_while(|line| line.strip_prefix('%').map(|said| (line, said.trim_start())))
        .any(|(line, said)| {
            Layout::of(line).is_some() || starts.iter().any(|start| said.starts_with(start))
        })
}

/// The fixes in strictly increasing order of time.
pub fn read(file: &str, text: &str) -> Result<(Vec<GnssFix>, Vec<Finding>), OpenError> {
    let mut layout = None;
    let mut fixes = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let (number, line) = (index + 1, line.trim());
        if line.starts_with('%') {
            // A receiver that starts anew repeats the header, perhaps with other settings.
            layout = Layout::of(line).or(layout);
        } else if !line.is_empty() {
            let Some(layout) = layout else {
                return Err(OpenError::line(
                    file,
                    number,
                    "no `%` line before this one names the columns",
                    "export the solution again with its header",
                ));
            };
            fixes.push((number, read_fix(file, number, line, layout)?));
        }
    }
    if fixes.is_empty() {
        return Err(OpenError::file(
            file,
            "has no GNSS fix",
            "compute the solution again, or remove the file",
        ));
    }
    let findings = put_in_order(file, &mut fixes);
    Ok((fixes.into_iter().map(|(_, fix)| fix).collect(), findings))
}

fn read_fix(file: &str, number: usize, line: &str, layout: Layout) -> Result<GnssFix, OpenError> {
    let wrong = |what: String| OpenError::line(file, number, what, "correct or delete the line");
    let fields: Vec<_> = split(line).collect();
    if fields.len() != layout.fields {
        return Err(OpenError::line(
            file,
            number,
            format!("{} fields where the header asks for {}", fields.len(), layout.fields),
            "the line may be cut short; complete or delete it",
        ));
    }
    let clock_s = clock_s(fields[0], fields[1])
        .ok_or_else(|| wrong(format!("`{} {}` is not a time", fields[0], fields[1])))?;
    let mut numbers = Vec::with_capacity(8);
    for field in &fields[2..=2 + layout.coordinates.fields()] {
        match field.parse::<f64>() {
            Ok(value) if value.is_finite() => numbers.push(value),
            _ => return Err(wrong(format!("`{field}` is not a number"))),
        }
    }
    let [coordinates @ .., quality] = &numbers[..] else {
        unreachable!("the quality follows the coordinates");
    };
    if quality.fract() != 0.0 || !(0.0..=LARGEST_QUALITY).contains(quality) {
        return Err(wrong(format!("{quality} in column `Q` is not a quality")));
    }
    let position_m = layout
        .coordinates
        .position_m(coordinates)
        .ok_or_else(|| wrong("latitude or longitude beyond the Earth's".to_owned()))?;
    Ok(GnssFix { time_s: layout.time_scale.unix_s(clock_s), position_m, quality: *quality as u8 })
}

/// Sorts by time and keeps the first of equal stamps, and says so.
fn put_in_order(file: &str, fixes: &mut Vec<(usize, GnssFix)>) -> Vec<Finding> {
    let mut findings = Vec::new();
    let late = fixes.windows(2).filter(|w| w[1].1.time_s < w[0].1.time_s).count();
    if late > 0 {
        fixes.sort_by(|a, b| a.1.time_s.total_cmp(&b.1.time_s));
        findings.push(Finding::warning(format!(
            "{late} out-of-order stamps in {file}; the fixes were sorted by time"
        )));
    }
    let before = fixes.len();
    let mut first_duplicate = None;
    fixes.dedup_by(|later, kept| {
        let same = later.1.time_s == kept.1.time_s;
        if same {
            first_duplicate.get_or_insert(later.0);
        }
        same
    });
    if let Some(line) = first_duplicate {
        findings.push(Finding::warning(format!(
            "{} duplicate stamps dropped (first at line {line} of {file})",
            before - fixes.len()
        )));
    }
    findings
}

/// The text that [`read`] reads, of fixes in ECEF: latitude, longitude and height at the times of GPS.
///
/// Positions to 0.1 mm, as RTKLIB writes them; the columns after the quality, which its own reader does not
/// need, are left out.
pub fn write(fixes: &[GnssFix]) -> String {
    let mut text = String::from(
        "% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float,3:sbas,4:dgps,5:single,6:ppp)\n\
         %  GPST                  latitude(deg) longitude(deg)  height(m)   Q\n",
    );
    for fix in fixes {
        let geodetic = Geodetic::from_ecef(fix.position_m);
        text += &format!(
            "{} {:14.9} {:14.9} {:10.4} {:3}\n",
            calendar(gpst_from_unix_s(fix.time_s)),
            geodetic.latitude_rad.to_degrees(),
            geodetic.longitude_rad.to_degrees(),
            geodetic.height_m,
            fix.quality,
        );
    }
    text
}

const DAY_S: f64 = 86_400.0;
const WEEK_S: f64 = 7.0 * DAY_S;

/// Days from 1970-01-01 to week 0 of GPS, 1980-01-06.
const GPS_WEEK_0_DAYS: i64 = 3657;

/// Year and month whose first second follows a leap second, since GPS time and UTC agreed (IERS Bulletin C).
const LEAPS: [(i64, i64); 18] = [
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

impl TimeScale {
    /// Unix time of a clock of this scale, read as if it were UTC's.
    fn unix_s(self, clock_s: f64) -> f64 {
        match self {
            Self::Gpst => unix_from_gpst_s(clock_s),
            Self::Utc => clock_s,
            Self::Jst => clock_s - 9.0 * 3600.0,
        }
    }
}

/// Unix times of the leap seconds, each with their number from then on.
fn leaps() -> impl Iterator<Item = (f64, f64)> {
    LEAPS
        .iter()
        .zip(1..)
        .map(|((year, month), n)| (days_from_civil(*year, *month, 1) as f64 * DAY_S, f64::from(n)))
}

fn unix_from_gpst_s(gpst_s: f64) -> f64 {
    gpst_s - leaps().take_while(|(since_s, n)| since_s + n <= gpst_s).count() as f64
}

fn gpst_from_unix_s(unix_s: f64) -> f64 {
    unix_s + leaps().take_while(|(since_s, _)| *since_s <= unix_s).count() as f64
}

/// Seconds from 1970-01-01 to what a clock shows: date and time of day, or week and its seconds.
fn clock_s(first: &str, second: &str) -> Option<f64> {
    if !first.contains('/') {
        let week: u16 = first.parse().ok()?;
        let of_week_s: f64 = second.parse().ok()?;
        let days = GPS_WEEK_0_DAYS + 7 * i64::from(week);
        return (0.0..WEEK_S).contains(&of_week_s).then_some(days as f64 * DAY_S + of_week_s);
    }
    let mut date = first.split('/').map(|part| part.parse::<u16>().ok().map(i64::from));
    let (year, month, day) = (date.next()??, date.next()??, date.next()??);
    let mut time = second.split(':');
    let (hour, minute) = (time.next()?.parse::<u8>().ok()?, time.next()?.parse::<u8>().ok()?);
    let seconds: f64 = time.next()?.parse().ok()?;
    let days = days_from_civil(year, month, day);
    // The day exists if the way back leads to it; the 61st second of a minute does in UTC.
    let right = year > 999
        && civil_from_days(days) == (year, month, day)
        && hour < 24
        && minute < 60
        && (0.0..61.0).contains(&seconds)
        && date.next().is_none()
        && time.next().is_none();
    let of_day_s = f64::from(hour) * 3600.0 + f64::from(minute) * 60.0 + seconds;
    right.then_some(days as f64 * DAY_S + of_day_s)
}

/// `yyyy/mm/dd hh:mm:ss.sss` of seconds since 1970-01-01.
fn calendar(clock_s: f64) -> String {
    // Whole milliseconds first: rounding the seconds alone would write the 60th.
    let clock_ms = (clock_s * 1e3).round() as i64;
    let (days, of_day_ms) = (clock_ms.div_euclid(86_400_000), clock_ms.rem_euclid(86_400_000));
    let (year, month, day) = civil_from_days(days);
    let (minutes, seconds) = (of_day_ms / 60_000, (of_day_ms % 60_000) as f64 / 1e3);
    let (hour, minute) = (minutes / 60, minutes % 60);
    format!("{year:04}/{month:02}/{day:02} {hour:02}:{minute:02}:{seconds:06.3}")
}

/// Days from 1970-01-01 to a date of the Gregorian calendar (Hinnant, "chrono-compatible low-level date
/// algorithms"). Its years begin in March, so that leap days come last; 719468 days lie before 1970 in them.
pub fn days_from_civil(year: i64, month: i64, day: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let era = year.div_euclid(400);
    let year_of_era = year.rem_euclid(400);
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    let day_of_era = 365 * year_of_era + year_of_era / 4 - year_of_era / 100 + day_of_year;
    146_097 * era + day_of_era - 719_468
}

/// The inverse of [`days_from_civil`]: year, month and day.
fn civil_from_days(days: i64) -> (i64, i64, i64) {
    let days = days + 719_468;
    let era = days.div_euclid(146_097);
    let day_of_era = days.rem_euclid(146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * from_march + 2) / 5 + 1;
    let month = (from_march + 2) % 12 + 1;
    (400 * era + year_of_era + i64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests;
