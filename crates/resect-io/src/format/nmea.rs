//! Logs of GNSS receivers in NMEA 0183: positions of GGA, dates of RMC or ZDA, standard deviations of GST.
//!
//! Source: NMEA 0183 as gpsd documents it (<https://gpsd.gitlab.io/gpsd/NMEA.html>). A sentence begins at `$`; text before it, such as the
//! stamp of a logger, is not read. Times are UTC. A time of day gets the date of the nearest sentence that has one.
//!
//! The height is that of the antenna above the sea plus the separation of the geoid, if every position has it. HDOP is not a standard
//! deviation: without GST, σ is unknown.

use jiff::civil::Date;

use super::gps_time::unix_of_day_s;
use super::table::{self, CORRECT};
use crate::error::OpenError;
use crate::findings::gnss::gnss_dates_missing;
use crate::findings::tracks::rows_skipped;
use crate::gnss_solution::{
    GnssSolution, GnssTrack, SolutionKind, SolutionPosition, covariance_of_roots,
    geodetic_of_degrees,
};
use crate::skipped_rows::SkippedRows;

/// Names of sentences by which a log is recognised.
const NAMES: [&str; 11] =
    ["GGA", "RMC", "ZDA", "GST", "GLL", "GNS", "GSA", "GSV", "VTG", "HDT", "GBS"];
/// Number of lines among which a sentence is searched.
const HEAD_LINES: usize = 50;
const DAY_S: f64 = 86_400.0;
/// Largest difference of the times of sentences of one epoch (s); receivers write them with 0.01 s or more digits.
const SAME_EPOCH_S: f64 = 1e-3;
/// Two-digit years from this one on belong to the last century: GPS began in 1980.
const FIRST_YEAR_OF_LAST_CENTURY: i16 = 80;

/// Content of a sentence.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sentence {
    Position(Gga),
    /// The receiver has no position.
    NoPosition,
    /// Time of day, and midnight of its date (Unix time, s).
    Date {
        of_day_s: f64,
        midnight_s: f64,
    },
    /// Time of day, and σ along east, north and up (m).
    Sigmas {
        of_day_s: f64,
        sigma_m: [f64; 3],
    },
    Other,
}

/// Position of a GGA sentence.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Gga {
    of_day_s: f64,
    degrees: [f64; 2],
    altitude_m: f64,
    separation_m: Option<f64>,
    kind: SolutionKind,
}

/// The sentences of a log, each with the index of its line.
#[derive(Debug, Default)]
struct Log {
    positions: Vec<(usize, Gga)>,
    /// Times of day and midnights (s).
    dates: Vec<(usize, f64, f64)>,
    /// Times of day and σ.
    sigmas: Vec<(usize, f64, [f64; 3])>,
    without_fix: usize,
}

/// Returns true for the beginning of a log.
pub fn looks_like(head: &str) -> bool {
    head.lines().take(HEAD_LINES).filter_map(body).any(|body| {
        let name = body.split(',').next().unwrap_or_default();
        name.len() == 5 && name.is_ascii() && NAMES.contains(&&name[2..])
    })
}

/// Returns the text of a sentence from behind its `$`.
fn body(line: &str) -> Option<&str> {
    let start = line.find('$')?;
    Some(line[start + 1..].trim_end())
}

/// Reads a log.
///
/// # Errors
/// If the sentences that are not valid outnumber the others, or if there is no position.
pub fn read(file: &str, text: &str) -> Result<GnssTrack, OpenError> {
    let has_checksums = text.lines().filter_map(body).any(|body| body.contains('*'));
    let (mut log, mut skipped, mut valid) = (Log::default(), SkippedRows::default(), 0);
    for (index, body) in
        text.lines().enumerate().filter_map(|(index, line)| Some((index, body(line)?)))
    {
        match checked(body, has_checksums).and_then(sentence) {
            Err(reason) => {
                skipped.add(index + 1, reason);
                continue;
            }
            Ok(Sentence::Position(gga)) => log.positions.push((index, gga)),
            Ok(Sentence::NoPosition) => log.without_fix += 1,
            Ok(Sentence::Date { of_day_s, midnight_s }) => {
                log.dates.push((index, of_day_s, midnight_s));
            }
            Ok(Sentence::Sigmas { of_day_s, sigma_m }) => {
                log.sigmas.push((index, of_day_s, sigma_m));
            }
            Ok(Sentence::Other) => {}
        }
        valid += 1;
    }
    skipped.refuse_if_most(file, valid, CORRECT)?;
    if log.positions.is_empty() && log.without_fix == 0 {
        let remedy = "let the receiver write GGA, with RMC or ZDA for the date and GST for σ";
        return Err(OpenError::file(file, "the log has no position (GGA)", remedy));
    }
    Ok(log.into_track(file, &skipped))
}

impl Log {
    fn into_track(self, file: &str, skipped: &SkippedRows) -> GnssTrack {
        let mut findings: Vec<_> = rows_skipped(file, skipped).into_iter().collect();
        if self.dates.is_empty() {
            findings.push(gnss_dates_missing(file));
        }
        let has_separations = self.positions.iter().all(|(_, gga)| gga.separation_m.is_some());
        let mut last_s = f64::NEG_INFINITY;
        let mut solutions = Vec::with_capacity(self.positions.len());
        for (index, gga) in &self.positions {
            let time_s = match self.dated_s(*index, gga.of_day_s) {
                Some(time_s) => time_s,
                None => after_midnight(gga.of_day_s, last_s),
            };
            last_s = time_s;
            let separation_m = gga.separation_m.filter(|_| has_separations).unwrap_or(0.0);
            let [latitude_deg, longitude_deg] = gga.degrees;
            let height_m = gga.altitude_m + separation_m;
            let geodetic = geodetic_of_degrees(latitude_deg, longitude_deg, height_m);
            let Some(geodetic) = geodetic else { continue };
            let sigma_m = self.sigma_m(*index, gga.of_day_s);
            solutions.push(GnssSolution {
                time_s,
                position: SolutionPosition::Geodetic(geodetic),
                kind: gga.kind,
                covariance_m2: sigma_m.and_then(|sigma_m| covariance_of_roots(sigma_m, [0.0; 3])),
            });
        }
        GnssTrack { solutions, without_fix: self.without_fix, findings }
    }

    /// Returns the Unix time of a time of day in a line (s), by the nearest date; `None` without any.
    fn dated_s(&self, index: usize, of_day_s: f64) -> Option<f64> {
        let after = self.dates.partition_point(|(line, _, _)| *line < index);
        let beside = [after.checked_sub(1), Some(after)];
        let dates = beside.into_iter().flatten().filter_map(|date| self.dates.get(date));
        let (_, dated_s, midnight_s) = dates.min_by_key(|(line, dated_s, _)| {
            let is_other_epoch = (dated_s - of_day_s).abs() > SAME_EPOCH_S;
            (is_other_epoch, line.abs_diff(index))
        })?;
        let days = ((dated_s - of_day_s) / DAY_S).round();
        Some(midnight_s + of_day_s + days * DAY_S)
    }

    /// Returns σ of the epoch of a line (m).
    fn sigma_m(&self, index: usize, of_day_s: f64) -> Option<[f64; 3]> {
        let after = self.sigmas.partition_point(|(line, _, _)| *line < index);
        let beside = [after.checked_sub(1), Some(after)];
        let mut sigmas = beside.into_iter().flatten().filter_map(|sigma| self.sigmas.get(sigma));
        sigmas
            .find(|(_, sigma_s, _)| (sigma_s - of_day_s).abs() < SAME_EPOCH_S)
            .map(|(_, _, sigma_m)| *sigma_m)
    }
}

/// Returns a time of day with as many days as put it after the last time (s).
fn after_midnight(of_day_s: f64, last_s: f64) -> f64 {
    match last_s.is_finite() {
        true => of_day_s + ((last_s - of_day_s) / DAY_S).round().max(0.0) * DAY_S,
        false => of_day_s,
    }
}

/// Returns a sentence without its checksum, or the reason why it is not valid.
fn checked(body: &str, has_checksums: bool) -> Result<&str, String> {
    let Some((content, checksum)) = body.split_once('*') else {
        return match has_checksums {
            true => Err("has no checksum; the line may be cut short".to_owned()),
            false => Ok(body),
        };
    };
    let stated = checksum.get(..2).and_then(|digits| u8::from_str_radix(digits, 16).ok());
    let sum = content.bytes().fold(0, |sum, byte| sum ^ byte);
    match stated {
        Some(stated) if stated == sum => Ok(content),
        _ => Err(format!("has a wrong checksum `{}`", table::shown(checksum))),
    }
}

/// Parses the content of a sentence, or returns the reason why it is not valid.
fn sentence(content: &str) -> Result<Sentence, String> {
    let fields: Vec<&str> = content.split(',').map(str::trim).collect();
    let name = fields[0].get(2..).filter(|_| fields[0].len() == 5 && !fields[0].starts_with('P'));
    let field = |index: usize| fields.get(index).copied().unwrap_or_default();
    let number = |index: usize, name: &str| match field(index).parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{}` is not a number ({name})", table::shown(field(index)))),
    };
    match name {
        Some("GGA") => gga(&fields),
        Some("RMC") if field(2) == "A" => {
            let (of_day_s, digits) = (time_of_day_s(field(1))?, field(9));
            let two_digits = |from: usize| digits.get(from..from + 2)?.parse::<i16>().ok();
            let date = (|| {
                let year = two_digits(4).filter(|_| digits.len() == 6)?;
                let century = if year < FIRST_YEAR_OF_LAST_CENTURY { 2000 } else { 1900 };
                date_of(two_digits(0)?, two_digits(2)?, century + year)
            })();
            let date = date.ok_or_else(|| format!("`{}` is not a date", table::shown(digits)))?;
            Ok(Sentence::Date { of_day_s, midnight_s: unix_of_day_s(date) })
        }
        Some("ZDA") if !field(4).is_empty() => {
            let of_day_s = time_of_day_s(field(1))?;
            let whole = |index: usize| field(index).parse::<i16>().ok();
            let date = (|| date_of(whole(2)?, whole(3)?, whole(4)?))();
            let date = date.ok_or_else(|| "has no valid date".to_owned())?;
            Ok(Sentence::Date { of_day_s, midnight_s: unix_of_day_s(date) })
        }
        Some("GST") if !field(6).is_empty() && !field(8).is_empty() => Ok(Sentence::Sigmas {
            of_day_s: time_of_day_s(field(1))?,
            sigma_m: [
                number(7, "σ of longitude")?,
                number(6, "σ of latitude")?,
                number(8, "σ of height")?,
            ],
        }),
        _ => Ok(Sentence::Other),
    }
}

fn gga(fields: &[&str]) -> Result<Sentence, String> {
    const FIELDS: usize = 11;
    if fields.len() < FIELDS {
        return Err(format!("GGA has only {} fields", fields.len()));
    }
    let kind = match fields[6] {
        "0" | "" => return Ok(Sentence::NoPosition),
        "1" => SolutionKind::Single,
        "2" | "3" => SolutionKind::Differential,
        "4" => SolutionKind::Fixed,
        "5" => SolutionKind::Float,
        "6" | "7" => SolutionKind::NotMeasured,
        _ => SolutionKind::Unstated,
    };
    let number = |field: &str| field.parse::<f64>().ok().filter(|value| value.is_finite());
    let altitude_m = number(fields[9])
        .ok_or_else(|| format!("`{}` is not an altitude", table::shown(fields[9])))?;
    let degrees = [angle_deg(fields[2], fields[3], "NS")?, angle_deg(fields[4], fields[5], "EW")?];
    let separation_m = fields.get(11).copied().and_then(number);
    let height_m = altitude_m + separation_m.unwrap_or(0.0);
    if geodetic_of_degrees(degrees[0], degrees[1], height_m).is_none() {
        return Err("latitude, longitude or height beyond the Earth's".to_owned());
    }
    let of_day_s = time_of_day_s(fields[1])?;
    Ok(Sentence::Position(Gga { of_day_s, degrees, altitude_m, separation_m, kind }))
}

/// Parses degrees and minutes such as `4646.9123`; the first of two letters is the positive side.
fn angle_deg(field: &str, side: &str, sides: &str) -> Result<f64, String> {
    let wrong = || format!("`{} {}` is not an angle", table::shown(field), table::shown(side));
    let whole = field.find('.').unwrap_or(field.len());
    let split = whole.checked_sub(2).filter(|_| field.is_ascii()).ok_or_else(wrong)?;
    let (degrees, minutes) = field.split_at(split);
    let degrees: f64 =
        if degrees.is_empty() { 0.0 } else { degrees.parse().map_err(|_| wrong())? };
    let minutes: f64 = minutes.parse().map_err(|_| wrong())?;
    let is_valid = degrees >= 0.0 && (0.0..60.0).contains(&minutes) && side.len() == 1;
    let sign = sides.find(side).filter(|_| is_valid).ok_or_else(wrong)?;
    let angle_deg = degrees + minutes / 60.0;
    Ok(if sign == 0 { angle_deg } else { -angle_deg })
}

/// Parses `hhmmss.ss` into seconds since midnight.
fn time_of_day_s(field: &str) -> Result<f64, String> {
    let wrong = || format!("`{}` is not a time", table::shown(field));
    let two_digits =
        |from: usize| field.get(from..from + 2).and_then(|digits| digits.parse::<u8>().ok());
    let (hour, minute) = two_digits(0).zip(two_digits(2)).ok_or_else(wrong)?;
    let second: f64 = field.get(4..).and_then(|rest| rest.parse().ok()).ok_or_else(wrong)?;
    // The 61st second of a minute exists in UTC.
    let is_valid = hour < 24 && minute < 60 && (0.0..61.0).contains(&second);
    let of_day_s = f64::from(hour) * 3600.0 + f64::from(minute) * 60.0 + second;
    is_valid.then_some(of_day_s).ok_or_else(wrong)
}

fn date_of(day: i16, month: i16, year: i16) -> Option<Date> {
    Date::new(year, month.try_into().ok()?, day.try_into().ok()?).ok()
}

#[cfg(test)]
mod tests;
