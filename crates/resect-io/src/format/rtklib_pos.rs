//! GNSS solutions in the format of RTKLIB and Emlid (`.pos`): one fix a line, below `%` lines that describe them.
//!
//! Sources: "Positioning solution file" in appendix B.1 of the RTKLIB manual 2.4.2, and for details `outsolheads` and `outsols` of
//! RTKLIB's `solution.c`. The `%` line with the columns begins with the time scale; three coordinates and the quality follow. The
//! user chooses the time scale, the coordinates and the separator. A stamp is a date and a time of day, or a week and its seconds,
//! both in the time scale of the header.
//!
//! Standard deviations and square roots of covariances follow the quality; RTKLIB states them along north, east, up for latitude and longitude,
//! and along the axes of Cartesian coordinates.
//!
//! Heights may be above the ellipsoid or the sea; they are read as ellipsoidal. Between antennas of one vehicle the difference is a few
//! parts in a million of their distance.

use crate::findings::tracks::{gnss_stamps_out_of_order, gnss_stamps_repeated};
use jiff::civil::Date;
use jiff::tz::Offset;
use nalgebra::Matrix3;

use super::gps_time::{clock_of_week_s, gpst_from_unix_s, unix_from_gpst_s, unix_of_day_s};
use crate::error::OpenError;
use crate::gnss_solution::{
    GnssSolution, GnssTrack, SolutionKind, SolutionPosition, covariance_of_roots,
    geodetic_of_degrees,
};
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
    Ecef,
    /// East, north, up from the base (m).
    Baseline,
}

/// Content of the line that names the columns.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Layout {
    time_scale: TimeScale,
    coordinates: Coordinates,
    /// Number of fields in each line.
    fields: usize,
    /// Field of the first of three standard deviations, which three square roots of covariances follow; `None` if it has none.
    sigmas: Option<usize>,
}

/// A line of a file.
struct SolutionLine {
    number: usize,
    quality: u8,
    solution: GnssSolution,
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
            ["x-ecef(m)", "y-ecef(m)", "z-ecef(m)", "Q"] => Coordinates::Ecef,
            ["e-baseline(m)", "n-baseline(m)", "u-baseline(m)", "Q"] => Coordinates::Baseline,
            _ => return None,
        };
        // A stamp is one column of two fields; an angle in degrees, minutes and seconds is one column of three.
        let further = 1 + coordinates.fields() - 3;
        let has_sigmas = names.windows(6).position(|names| names == coordinates.sigma_names());
        let sigmas = has_sigmas.map(|column| column + further);
        Some(Self { time_scale, coordinates, fields: names.len() + further, sigmas })
    }
}

impl Coordinates {
    fn fields(self) -> usize {
        if self == Self::DegreesMinutesSeconds { 7 } else { 3 }
    }

    /// Names of three standard deviations and of three square roots of covariances.
    fn sigma_names(self) -> [&'static str; 6] {
        match self {
            Self::Degrees | Self::DegreesMinutesSeconds => {
                ["sdn(m)", "sde(m)", "sdu(m)", "sdne(m)", "sdeu(m)", "sdun(m)"]
            }
            Self::Ecef => ["sdx(m)", "sdy(m)", "sdz(m)", "sdxy(m)", "sdyz(m)", "sdzx(m)"],
            Self::Baseline => ["sde(m)", "sdn(m)", "sdu(m)", "sden(m)", "sdnu(m)", "sdue(m)"],
        }
    }

    /// Returns the position; `None` for coordinates that are not on earth. `numbers` has as many values as there are fields.
    fn position(self, numbers: &[f64]) -> Option<SolutionPosition> {
        let (latitude_deg, longitude_deg, height_m) = match (self, numbers) {
            (Self::Ecef, [x, y, z]) => return Some(SolutionPosition::Ecef([*x, *y, *z].into())),
            (Self::Baseline, [east, north, up]) => {
                return Some(SolutionPosition::Baseline([*east, *north, *up].into()));
            }
            (Self::Degrees, [latitude, longitude, height]) => (*latitude, *longitude, *height),
            (Self::DegreesMinutesSeconds, [d, m, s, e, n, t, height]) => {
                (degrees(*d, *m, *s), degrees(*e, *n, *t), *height)
            }
            _ => unreachable!("there are as many numbers as fields"),
        };
        geodetic_of_degrees(latitude_deg, longitude_deg, height_m).map(SolutionPosition::Geodetic)
    }

    /// Returns the covariance along east, north and up (m²) of the standard deviations in a line; `None` if they are unset.
    fn covariance_m2(self, stated: [f64; 6], position: SolutionPosition) -> Option<Matrix3<f64>> {
        let [a, b, c, ab, bc, ca] = stated;
        match self {
            // North and east are exchanged.
            Self::Degrees | Self::DegreesMinutesSeconds => {
                covariance_of_roots([b, a, c], [ab, ca, bc])
            }
            Self::Baseline => covariance_of_roots([a, b, c], [ab, bc, ca]),
            Self::Ecef => {
                let local = Geodetic::from_ecef(position.cartesian_m()).ecef_from_local();
                Some(local.transpose() * covariance_of_roots([a, b, c], [ab, bc, ca])? * local)
            }
        }
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
    let fix = |line: SolutionLine| {
        let SolutionLine { number, quality, solution } = line;
        let position_m = solution.position.cartesian_m();
        (number, GnssFix { time_s: solution.time_s, position_m, quality })
    };
    let mut fixes = solution_lines(file, text)?.into_iter().map(fix).collect();
    let findings = put_in_order(file, &mut fixes);
    Ok((fixes.into_iter().map(|(_, fix)| fix).collect(), findings))
}

/// Reads the solutions of one receiver with their covariances.
pub fn read_track(file: &str, text: &str) -> Result<GnssTrack, OpenError> {
    let mut track = GnssTrack::default();
    for line in solution_lines(file, text)? {
        match line.quality {
            0 => track.without_fix += 1,
            _ => track.solutions.push(line.solution),
        }
    }
    Ok(track)
}

fn solution_lines(file: &str, text: &str) -> Result<Vec<SolutionLine>, OpenError> {
    let mut layout = None;
    let mut solutions = Vec::new();
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
            solutions.push(read_solution(file, number, line, layout)?);
        }
    }
    if solutions.is_empty() {
        return Err(OpenError::file(
            file,
            "has no GNSS fix",
            "compute the solution again, or remove the file",
        ));
    }
    Ok(solutions)
}

/// Returns the kind of a quality of RTKLIB; 0 is no solution.
fn kind_of(quality: u8) -> SolutionKind {
    match quality {
        1 => SolutionKind::Fixed,
        2 => SolutionKind::Float,
        3 | 4 => SolutionKind::Differential,
        5 => SolutionKind::Single,
        6 => SolutionKind::Ppp,
        7 => SolutionKind::NotMeasured,
        _ => SolutionKind::Unstated,
    }
}

fn read_solution(
    file: &str,
    number: usize,
    line: &str,
    layout: Layout,
) -> Result<SolutionLine, OpenError> {
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
    let position = layout
        .coordinates
        .position(coordinates)
        .ok_or_else(|| wrong("latitude, longitude or height beyond the Earth's".to_owned()))?;
    let stated = layout.sigmas.map(|first| {
        let mut values = [f64::NAN; 6];
        for (value, field) in values.iter_mut().zip(&fields[first..]) {
            *value = field.parse().unwrap_or(f64::NAN);
        }
        values
    });
    let covariance_m2 =
        stated.and_then(|stated| layout.coordinates.covariance_m2(stated, position));
    let quality = *quality as u8;
    let (time_s, kind) = (layout.time_scale.unix_s(clock_s), kind_of(quality));
    let solution = GnssSolution { time_s, position, kind, covariance_m2 };
    Ok(SolutionLine { number, quality, solution })
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

/// Returns the seconds from 1970-01-01 to a clock reading: date and time of day, or week and its seconds.
fn clock_s(first: &str, second: &str) -> Option<f64> {
    if !first.contains('/') {
        let week: u16 = first.parse().ok()?;
        return clock_of_week_s(week, second.parse().ok()?);
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

#[cfg(test)]
mod tests;
