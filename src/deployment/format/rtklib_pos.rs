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
    /// The same with degrees, minutes and seconds as fields of their own.
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
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// 2019/06/08 08:03:55.5 of GPS is week 2056, 547435.5 s; UTC is 18 s behind.
    const STAMP_S: f64 = 1_559_981_017.5;

    const DEGREES: &str = "\
% program   : RTKLIB ver.demo5 b31
% inp file  : rover_2019-06-08_08-03-52.obs
% obs start : 2019/06/08 08:03:55.5 GPST (week2056 547435.5s)
% ref pos   : 47.060027749  -1.350495019   84.8600
%
% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float,3:sbas,4:dgps,5:single,6:ppp,ns=# of satellites)
%  GPST                  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio
2019/06/08 08:03:55.500   47.060100000   -0.350500000    85.1234   1   9   0.0100   0.0100   0.0200   0.0010      nan   0.0010  -0.50    4.2
2019/06/08 08:03:55.700   47.060100000   -0.350500000    85.1234   2   9   0.0100   0.0100   0.0200   0.0010   0.0010   0.0010  -0.30    1.2
";

    fn position_m() -> Vector3<f64> {
        Geodetic {
            latitude_rad: 47.0601_f64.to_radians(),
            longitude_rad: -0.3505_f64.to_radians(),
            height_m: 85.1234,
        }
        .to_ecef()
    }

    /// A file of one line under the header with these columns.
    fn one(columns: &str, line: &str) -> Result<GnssFix, OpenError> {
        let text = format!("% program   : RTKLIB ver.2.4.2\r\n%  {columns}   Q  ns\r\n{line}\r\n");
        assert!(looks_like(&text), "{columns}");
        read("a.pos", &text).map(|(fixes, findings)| {
            assert_eq!((fixes.len(), findings), (1, vec![]));
            fixes[0]
        })
    }

    #[test]
    fn a_file_of_rtkpost() {
        assert!(looks_like(DEGREES));
        let (fixes, findings) = read("a.pos", DEGREES).expect("well-formed");
        assert_eq!(findings, []);
        assert_eq!(fixes.iter().map(|fix| fix.quality).collect::<Vec<_>>(), [1, 2]);
        assert!((fixes[0].time_s - STAMP_S).abs() < 1e-6);
        assert!((fixes[1].time_s - fixes[0].time_s - 0.2).abs() < 1e-6);
        assert!((fixes[0].position_m - position_m()).norm() < 1e-6);
    }

    #[test]
    fn coordinates_scales_and_separators_are_the_user_s_choice() {
        let degrees = "latitude(deg) longitude(deg)  height(m)";
        let p = position_m();
        let ecef = format!("x-ecef(m) {:.4} {:.4} {:.4}", p.x, p.y, p.z);
        let ecef = ecef.trim_start_matches("x-ecef(m) ");
        let cases = [
            // 47.0601° = 47° 3′ 36.36″; −0.3505° = −0° 21′ 1.8″.
            (
                "GPST  latitude(d'\")   longitude(d'\")  height(m)".to_owned(),
                "2019/06/08 08:03:55.500  47 03 36.36000   -0 21 01.80000    85.1234   1   9"
                    .to_owned(),
            ),
            (
                "GPST      x-ecef(m)      y-ecef(m)      z-ecef(m)".to_owned(),
                format!("2056 547435.500 {ecef} 1 9"),
            ),
            (
                format!("UTC   {degrees}"),
                "2019/06/08 08:03:37.500 47.0601 -0.3505 85.1234 1 9".to_owned(),
            ),
            (format!("UTC   {degrees}"), "2056 547417.500 47.0601 -0.3505 85.1234 1 9".to_owned()),
            (
                format!("JST   {degrees}"),
                "2019/06/08 17:03:37.500 47.0601 -0.3505 85.1234 1 9".to_owned(),
            ),
        ];
        for (columns, line) in &cases {
            for separator in [" ", ",", "\t", ";", " , "] {
                let columns = columns.split_whitespace().collect::<Vec<_>>().join(separator);
                // A date and a time of day stay one column with a space in it.
                let line = line.split_whitespace().collect::<Vec<_>>().join(separator);
                let line = if line.contains('/') { line.replacen(separator, " ", 1) } else { line };
                let fix = one(&columns, &line).expect("well-formed");
                assert!((fix.time_s - STAMP_S).abs() < 1e-6, "{columns}\n{line}\n{fix:?}");
                let apart_m = (fix.position_m - position_m()).norm();
                assert!(apart_m < 1e-3, "{apart_m} m: {columns}\n{line}");
                assert_eq!(fix.quality, 1);
            }
        }
        let baseline = "GPST   e-baseline(m)  n-baseline(m)  u-baseline(m)";
        let fix = one(baseline, "2056 547435.500 -12.3456 7.8901 0.1234 2 9").expect("well-formed");
        assert_eq!((fix.position_m, fix.quality), (Vector3::new(-12.3456, 7.8901, 0.1234), 2));
    }

    #[test]
    fn leap_seconds_come_at_midnight_of_utc() {
        // The last leap second so far: GPS was 17 s ahead, then 18 s.
        let midnight_s = 1_483_228_800.0;
        assert_eq!(unix_from_gpst_s(midnight_s + 16.0), midnight_s - 1.0);
        assert_eq!(unix_from_gpst_s(midnight_s + 18.0), midnight_s);
        assert_eq!(gpst_from_unix_s(midnight_s - 1.0), midnight_s + 16.0);
        assert_eq!(gpst_from_unix_s(midnight_s), midnight_s + 18.0);
        // The number since 2006, and none when GPS began.
        assert_eq!(gpst_from_unix_s(1_136_073_600.0) - 1_136_073_600.0, 14.0);
        assert_eq!(clock_s("0", "0").map(unix_from_gpst_s), Some(315_964_800.0));
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        let columns = "GPST latitude(deg) longitude(deg) height(m)";
        for (line, expected) in [
            (
                "2019/06/08 08:03:55.5 47.1 -0.3 85.1",
                "a.pos:3: 5 fields where the header asks for 7",
            ),
            // A decimal comma.
            ("2019/06/08 08:03:55.5 47,1 -0,3 85,1 1 9", "10 fields"),
            ("2019/02/29 08:03:55.5 47.1 -0.3 85.1 1 9", "`2019/02/29 08:03:55.5` is not a time"),
            ("19/06/08 08:03:55.5 47.1 -0.3 85.1 1 9", "not a time"),
            ("2019/06/08 24:03:55.5 47.1 -0.3 85.1 1 9", "not a time"),
            ("2019/06/08 08:03 47.1 -0.3 85.1 1 9", "not a time"),
            ("2056 604800.0 47.1 -0.3 85.1 1 9", "not a time"),
            ("2056 nan 47.1 -0.3 85.1 1 9", "not a time"),
            ("2056 1.0 nan -0.3 85.1 1 9", "`nan` is not a number"),
            ("2056 1.0 47.1 -0.3 85.1x 1 9", "`85.1x` is not a number"),
            ("2056 1.0 47.1 -0.3 85.1 1.5 9", "1.5 in column `Q` is not a quality"),
            ("2056 1.0 47.1 -0.3 85.1 12 9", "12 in column `Q` is not a quality"),
            ("2056 1.0 97.1 -0.3 85.1 1 9", "latitude or longitude"),
            ("", "a.pos: has no GNSS fix"),
        ] {
            let error = one(columns, line).expect_err(line).to_string();
            assert!(error.contains(expected), "`{line}` gives: {error}");
        }
        let bare = read("a.pos", "2056 1.0 47.1 -0.3 85.1 1 9\n").expect_err("no header");
        assert!(bare.to_string().starts_with("a.pos:1: no `%` line"), "{bare}");
    }

    #[test]
    fn stamps_are_put_in_order_and_duplicates_dropped() {
        let text = "% GPST e-baseline(m) n-baseline(m) u-baseline(m) Q\n\
            2056 2.0 2 0 0 1\n\
            2056 1.0 1 0 0 1\n\
            2056 2.0 9 0 0 1\n\
            2056 3.0 3 0 0 1\n";
        let (fixes, findings) = read("a.pos", text).expect("well-formed");
        assert_eq!(fixes.iter().map(|fix| fix.position_m.x).collect::<Vec<_>>(), [1.0, 2.0, 3.0]);
        assert!(fixes.windows(2).all(|w| w[0].time_s < w[1].time_s));
        let said = findings.iter().map(ToString::to_string).collect::<Vec<_>>();
        assert_eq!(
            said,
            [
                "1 out-of-order stamps in a.pos; the fixes were sorted by time",
                "1 duplicate stamps dropped (first at line 4 of a.pos)",
            ]
        );
    }

    #[test]
    fn a_header_in_the_middle_counts_from_there() {
        let text = "% UTC x-ecef(m) y-ecef(m) z-ecef(m) Q\n2056 1.0 1 2 3 1\n\
            % a remark changes nothing\n2056 2.0 1 2 3 1\n\
            % GPST x-ecef(m) y-ecef(m) z-ecef(m) Q ns\n2056 30.0 1 2 3 1 9\n";
        let (fixes, _) = read("a.pos", text).expect("well-formed");
        assert_eq!(fixes[2].time_s - fixes[0].time_s, 11.0);
    }

    #[test]
    fn other_files_do_not_look_like_it() {
        assert!(looks_like("\n% inp file  : rover.obs\n% inp fi"));
        assert!(looks_like("%  GPST , latitude(deg),longitude(deg), height(m),  Q\n"));
        for other in [
            "",
            "% a LaTeX file about GPST\n\\documentclass{article}\n",
            "timestamp,id,distance,ha,va\n1,1,2,3,1.5\n",
            "2019/06/08 08:03:55.500 47.06 -0.35 85.12 1 9\n",
            "a note\n% program   : RTKLIB\n",
        ] {
            assert!(!looks_like(other), "{other}");
        }
    }

    proptest! {
        #[test]
        fn what_is_written_is_read(
            // From before GPS began to 2099.
            stamps_ms in proptest::collection::btree_set(-1_000_000_000..4_100_000_000_000_i64, 1..20),
            latitude_rad in -1.57..1.57f64,
            longitude_rad in -3.1..3.1f64,
            height_m in -400.0..9000.0f64,
            quality in 0..=7u8,
        ) {
            let position_m = Geodetic { latitude_rad, longitude_rad, height_m }.to_ecef();
            let fixes: Vec<_> = stamps_ms
                .iter()
                .map(|ms| GnssFix { time_s: *ms as f64 / 1e3, position_m, quality })
                .collect();
            let text = write(&fixes);
            prop_assert!(looks_like(&text));
            let (back, findings) = read("a.pos", &text).expect("well-formed");
            prop_assert_eq!(findings, vec![]);
            prop_assert_eq!(back.len(), fixes.len());
            for (back, fix) in back.iter().zip(&fixes) {
                prop_assert!((back.time_s - fix.time_s).abs() < 1e-5);
                prop_assert!((back.position_m - fix.position_m).norm() < 1e-4);
                prop_assert_eq!(back.quality, fix.quality);
            }
        }

        #[test]
        fn dates_are_a_way_there_and_back(days in -700_000..2_900_000_i64) {
            let (year, month, day) = civil_from_days(days);
            prop_assert!((1..=12).contains(&month) && (1..=31).contains(&day));
            prop_assert_eq!(days_from_civil(year, month, day), days);
            // Consecutive days are consecutive dates.
            prop_assert!((year, month, day) < civil_from_days(days + 1));
        }

        #[test]
        fn no_text_panics(text in "[%0-9/:., \\-\nGPSTQxyz()aemnurc]{0,200}") {
            let _ = looks_like(&text);
            let _ = read("a.pos", &format!("% GPST x-ecef(m) y-ecef(m) z-ecef(m) Q\n{text}"));
        }
    }
}
