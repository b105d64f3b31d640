//! GNSS solutions in the format of RTKLIB and Emlid (`.pos`): one fix a line, below `%` lines that describe them.
//!
//! Sources: "Positioning solution file" in appendix B.1 of the RTKLIB manual 2.4.2, and for details `outsolheads` and `outsols` of
//! RTKLIB's `solution.c`. The `%` line with the columns begins with the time scale; three coordinates and the quality follow. The
//! user chooses the time scale, the coordinates and the separator. A stamp is a date and a time of day, or a week and its seconds,
//! both in the time scale of the header.
//!
//! Heights may be above the ellipsoid or the sea; they are read as ellipsoidal. Between antennas of one vehicle the difference is a few
//! parts in a million of their distance.

use crate::findings::tracks::{gnss_stamps_out_of_order, gnss_stamps_repeated};
use jiff::civil::{Date, date};
use jiff::tz::Offset;
use nalgebra::Vector3;

use crate::error::OpenError;
use resect_core::deployment::{Finding, GnssFix};
use resect_core::geometry::Geodetic;

/// Largest quality of RTKLIB (`MAXSOLQ`).
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
    /// Latitude, longitude (degrees, minutes and seconds in separate fields), height (m).
    DegreesMinutesSeconds,
    /// ECEF, or east, north, up from the base (m).
    Cartesian,
}

/// Content of the line that names the columns.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Layout {
    time_scale: TimeScale,
    coordinates: Coordinates,
    /// Number of fields in each line.
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
        // A stamp is one column of two fields; an angle in degrees, minutes and seconds is one column of three.
        let fields = names.len() + 1 + coordinates.fields() - 3;
        Some(Self { time_scale, coordinates, fields })
    }
}

impl Coordinates {
    fn fields(self) -> usize {
        if self == Self::DegreesMinutesSeconds { 7 } else { 3 }
    }

    /// Returns the position (m); `None` for coordinates that are not on earth. `numbers` has as many values as there are fields.
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

/// Converts to degrees. The sign of the degrees applies to the whole angle, also for "-0".
fn degrees(degrees: f64, minutes: f64, seconds: f64) -> f64 {
    (degrees.abs() + minutes / 60.0 + seconds / 3600.0).copysign(degrees)
}

/// Splits a line at any separator that the user can choose; spaces pad the columns with all of them.
fn split(line: &str) -> impl Iterator<Item = &str> {
    line.split([' ', '\t', ',', ';']).filter(|field| !field.is_empty())
}

/// Returns true for the beginning of a solution file, even if it ends before the line that names the columns.
pub fn looks_like(head: &str) -> bool {
    // First words of RTKPOST's header: the program or, with the short header, the legend.
    let starts =
        ["program   :", "inp file  :", "(lat/lon/height=", "(x/y/z-ecef=", "(e/n/u-baseline="];
    head.lines()
        .filter(|line| !line.trim().is_empty())
        .map_while(|line| line.strip_prefix('%').map(|said| (line, said.trim_start())))
        .any(|(line, said)| {
            Layout::of(line).is_some() || starts.iter().any(|start| said.starts_with(start))
        })
}

/// Reads the fixes in strictly increasing order of time.
pub fn read(file: &str, text: &str) -> Result<(Vec<GnssFix>, Vec<Finding>), OpenError> {
    let mut layout = None;
    let mut fixes = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let (number, line) = (index + 1, line.trim());
        if line.starts_with('%') {
            // A receiver that restarts repeats the header, possibly with other settings.
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

/// Sorts by time, keeps the first of equal stamps, and returns findings about both.
fn put_in_order(file: &str, fixes: &mut Vec<(usize, GnssFix)>) -> Vec<Finding> {
    let mut findings = Vec::new();
    let late = fixes.windows(2).filter(|w| w[1].1.time_s < w[0].1.time_s).count();
    if late > 0 {
        fixes.sort_by(|a, b| a.1.time_s.total_cmp(&b.1.time_s));
        findings.push(gnss_stamps_out_of_order(file, late));
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
        findings.push(gnss_stamps_repeated(file, before - fixes.len(), line));
    }
    findings
}

/// Returns a text that [`read`] reads, from fixes in ECEF: latitude, longitude and height at GPS time.
///
/// Positions have 0.1 mm, as RTKLIB writes them; the columns after the quality are left out, since RTKLIB's reader does not need
/// them.
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

impl TimeScale {
    /// Converts seconds from 1970 on a clock of this scale to Unix time.
    fn unix_s(self, clock_s: f64) -> f64 {
        match self {
            Self::Gpst => unix_from_gpst_s(clock_s),
            Self::Utc => clock_s,
            Self::Jst => clock_s - 9.0 * 3600.0,
        }
    }
}

/// Unix times of the leap seconds, each with the total number from then on.
fn leaps() -> impl Iterator<Item = (f64, f64)> {
    LEAPS
        .iter()
        .zip(1..)
        .map(|((year, month), n)| (unix_of_day_s(date(*year, *month, 1)), f64::from(n)))
}

fn unix_from_gpst_s(gpst_s: f64) -> f64 {
    gpst_s - leaps().take_while(|(since_s, n)| since_s + n <= gpst_s).count() as f64
}

fn gpst_from_unix_s(unix_s: f64) -> f64 {
    unix_s + leaps().take_while(|(since_s, _)| *since_s <= unix_s).count() as f64
}

/// Returns the seconds from 1970-01-01 to a clock reading: date and time of day, or week and its seconds.
fn clock_s(first: &str, second: &str) -> Option<f64> {
    if !first.contains('/') {
        let week: u16 = first.parse().ok()?;
        let of_week_s: f64 = second.parse().ok()?;
        let week_s = unix_of_day_s(GPS_WEEK_0) + f64::from(week) * WEEK_S;
        return (0.0..WEEK_S).contains(&of_week_s).then_some(week_s + of_week_s);
    }
    let mut parts = first.split('/');
    let year: i16 = parts.next()?.parse().ok()?;
    let (month, day) = (parts.next()?.parse::<u8>().ok()?, parts.next()?.parse::<u8>().ok()?);
    let day = Date::new(year, month.try_into().ok()?, day.try_into().ok()?).ok()?;
    let mut time = second.split(':');
    let (hour, minute) = (time.next()?.parse::<u8>().ok()?, time.next()?.parse::<u8>().ok()?);
    let seconds: f64 = time.next()?.parse().ok()?;
    // The 61st second of a minute exists in UTC.
    let right = year > 999
        && hour < 24
        && minute < 60
        && (0.0..61.0).contains(&seconds)
        && parts.next().is_none()
        && time.next().is_none();
    let of_day_s = f64::from(hour) * 3600.0 + f64::from(minute) * 60.0 + seconds;
    right.then_some(unix_of_day_s(day) + of_day_s)
}

/// Formats seconds since 1970-01-01 as `yyyy/mm/dd hh:mm:ss.sss`.
fn calendar(clock_s: f64) -> String {
    // Rounds to milliseconds first, because formatting truncates.
    let clock_ms = (clock_s * 1e3).round() as i64;
    let [first, last] = [jiff::Timestamp::MIN, jiff::Timestamp::MAX];
    let stamp = jiff::Timestamp::from_millisecond(clock_ms);
    let stamp = stamp.unwrap_or(if clock_ms < 0 { first } else { last });
    Offset::UTC.to_datetime(stamp).strftime("%Y/%m/%d %H:%M:%S%.3f").to_string()
}

/// Returns the seconds from 1970-01-01 to a date, with days of equal length.
fn unix_of_day_s(day: Date) -> f64 {
    day.duration_since(date(1970, 1, 1)).as_secs_f64()
}

#[cfg(test)]
mod tests;
