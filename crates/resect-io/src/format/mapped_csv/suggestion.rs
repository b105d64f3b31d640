//! Suggestion of the columns of an unknown table, from their names and their first numbers.

use std::borrow::Cow;
use std::f64::consts::PI;

use super::head::first_rows;
use crate::format::table::{self, separator, with_point};
use resect_core::deployment::ColumnMapping;
use resect_core::deployment::{TableAngle, TableLength, TimeFormat, VerticalAngle};
use resect_core::statistics::median;

/// Names of a column in English, German and French, without unit, with letters and digits only: complete names, and substrings.
struct Names(&'static [&'static str], &'static [&'static str]);

const TIME: Names = Names(
    &["t", "s", "sec", "utc"],
    &["time", "stamp", "epoch", "date", "zeit", "datum", "temps", "heure"],
);
const STATION: Names = Names(
    &["id", "rts", "st", "station", "stationid"],
    &["station", "theodolite", "instrument", "standpunkt", "tachymeter"],
);
const RANGE: Names =
    Names(&["d", "sd", "r", "di"], &["slope", "distance", "range", "dist", "strecke"]);
const AZIMUTH: Names = Names(
    &["ha", "hz", "az", "hr", "h", "azi"],
    &["azimut", "horizontal", "hangle", "hzangle", "bearing", "richtung", "direction"],
);
const VERTICAL: Names = Names(
    &["va", "v", "vz", "ze", "zd", "el", "elev"],
    &["zenit", "vertical", "vertikal", "vangle", "elevation", "altitude"],
);
const X: Names = Names(&["x", "xm", "xmm", "e", "east", "posx"], &["easting"]);
const Y: Names = Names(&["y", "ym", "ymm", "n", "north", "posy"], &["northing"]);
const Z: Names = Names(&["z", "zm", "zmm", "u", "up", "posz"], &["height"]);
const STATUS: Names = Names(&[], &["status", "returncode", "errorcode"]);

/// Units at the end of column names.
const UNITS: [&str; 18] = [
    "m", "mm", "ft", "feet", "ftus", "usft", "rad", "deg", "degree", "degrees", "gon", "grad",
    "gons", "dms", "s", "ms", "us", "ns",
];

/// The first rows of a table.
struct Head<'a> {
    names: Vec<String>,
    rows: Vec<Vec<Cow<'a, str>>>,
    decimal_comma: bool,
}

impl<'a> Head<'a> {
    /// Parses the first rows; empty if the header cannot be split.
    fn of(head: &'a str) -> Self {
        let (header, rows) = first_rows(head);
        let separator = separator(&header);
        let names = table::fields(&header, separator).unwrap_or_default();
        let names = names.into_iter().map(Cow::into_owned).collect();
        let rows = rows.into_iter().filter_map(|(_, row)| row.ok()).collect();
        Self { names, rows, decimal_comma: separator != ',' }
    }

    /// Returns the texts of a column with a decimal point; empty if the column does not exist.
    fn texts(&self, column: Option<&str>) -> Vec<String> {
        let at = column.and_then(|column| self.names.iter().position(|name| name == column));
        let Some(at) = at else { return Vec::new() };
        self.rows.iter().map(|row| with_point(&row[at], self.decimal_comma).into_owned()).collect()
    }
}

/// Suggests the most probable mapping for a table that begins with `head`. Columns that are not recognised are left unnamed.
pub fn suggest(head: &str) -> ColumnMapping {
    let read = Head::of(head);
    let names: Vec<&str> = read.names.iter().map(String::as_str).collect();
    let mut free: Vec<bool> = vec![true; names.len()];
    let mut take = |wanted: &Names| {
        let found = find(&names, &free, wanted)?;
        free[found] = false;
        Some(names[found].to_owned())
    };
    // Each column is chosen only once, so the order of these searches matters.
    let time = take(&TIME);
    let [status, range, azimuth, vertical] = [&STATUS, &RANGE, &AZIMUTH, &VERTICAL].map(&mut take);
    let station = take(&STATION);
    let polar = range.is_some() && azimuth.is_some() && vertical.is_some();
    let [x, y, z] = if polar { [None, None, None] } else { [&X, &Y, &Z].map(&mut take) };
    let cartesian = x.is_some() && y.is_some() && z.is_some();
    let if_polar = |name: Option<String>| name.filter(|_| !cartesian);
    let if_cartesian = |name: Option<String>| name.filter(|_| cartesian);
    let mut mapping = ColumnMapping {
        time: time.unwrap_or_default(),
        station,
        range: if_polar(range),
        azimuth: if_polar(azimuth),
        vertical: if_polar(vertical),
        x: if_cartesian(x),
        y: if_cartesian(y),
        z: if_cartesian(z),
        status,
        ..ColumnMapping::default()
    };
    suggest_meanings(head, &ColumnMapping::default(), &mut mapping);
    mapping
}

/// Suggests units, senses and the format of times for those columns that `before` did not name.
pub fn suggest_meanings(head: &str, before: &ColumnMapping, mapping: &mut ColumnMapping) {
    let head = Head::of(head);
    let lengths = |mapping: &ColumnMapping| mapping.range.clone().or_else(|| mapping.x.clone());
    let angles = |mapping: &ColumnMapping| [mapping.azimuth.clone(), mapping.vertical.clone()];
    if mapping.time != before.time {
        mapping.time_format = time_format(&head.texts(Some(&mapping.time)));
    }
    let named = lengths(mapping);
    if named != lengths(before) {
        let values = numbers(&head.texts(named.as_deref()));
        mapping.length_unit = length_unit(&named.unwrap_or_default(), &values);
    }
    let named = angles(mapping);
    if named != angles(before) {
        let [azimuths, verticals] = named.each_ref().map(|name| head.texts(name.as_deref()));
        mapping.angle_unit =
            angle_unit(&named.map(Option::unwrap_or_default), &azimuths, &verticals);
        mapping.vertical_angle = vertical_angle(&verticals, mapping.angle_unit);
    }
}

/// Returns the first free column with one of the names.
fn find(names: &[&str], free: &[bool], Names(whole, parts): &Names) -> Option<usize> {
    let plain: Vec<String> = names.iter().map(|name| without_unit(name)).collect();
    let first =
        |is: &dyn Fn(&str) -> bool| (0..names.len()).find(|at| free[*at] && is(&plain[*at]));
    // Substrings are in order of significance.
    let by_part = || parts.iter().find_map(|part| first(&|name| name.contains(part)));
    first(&|name| whole.contains(&name)).or_else(by_part)
}

/// Returns a column's name in lower-case letters and digits, without brackets and their content, and without a unit at its end.
fn without_unit(name: &str) -> String {
    let name = name.to_lowercase();
    let name = name.split(['(', '[', '<']).next().unwrap_or_default();
    let mut words: Vec<&str> = words(name).collect();
    if words.len() > 1 && words.last().is_some_and(|last| UNITS.contains(last)) {
        words.pop();
    }
    words.concat().chars().filter(char::is_ascii_alphanumeric).collect()
}

fn words(name: &str) -> impl Iterator<Item = &str> {
    name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty())
}

fn numbers(texts: &[String]) -> Vec<f64> {
    texts
        .iter()
        .filter_map(|text| text.parse().ok())
        .filter(|value: &f64| value.is_finite())
        .collect()
}

fn time_format(texts: &[String]) -> TimeFormat {
    let Some(first) = texts.first() else { return TimeFormat::Seconds };
    if first.contains(':') {
        let has_date = first.contains(['T', ' ', '/']);
        return if has_date { TimeFormat::Calendar } else { TimeFormat::TimeOfDay };
    }
    let stamps = numbers(texts);
    let steps = stamps.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0);
    match (median(stamps.iter().copied()).unwrap_or(0.0), median(steps).unwrap_or(0.0)) {
        (stamp, _) if stamp > 1e17 => TimeFormat::Nanoseconds,
        (stamp, _) if stamp > 1e14 => TimeFormat::Microseconds,
        (stamp, _) if stamp > 1e11 => TimeFormat::Milliseconds,
        (_, step) if step > 1e7 => TimeFormat::Nanoseconds,
        (_, step) if step > 1e4 => TimeFormat::Microseconds,
        // Rows of three stations follow each other several times a second.
        (_, step) if step > 5.0 => TimeFormat::Milliseconds,
        _ => TimeFormat::Seconds,
    }
}

fn angle_unit(names: &[String; 2], azimuths: &[String], verticals: &[String]) -> TableAngle {
    let is_sexagesimal =
        |text: &String| text.parse::<f64>().is_err() && text.chars().any(|c| c.is_ascii_digit());
    if verticals.first().is_some_and(is_sexagesimal) {
        return TableAngle::DegreesMinutesSeconds;
    }
    // "Grad" means degrees in German and gon elsewhere, so only the numbers decide.
    let named = names.join(" ").to_lowercase();
    for (unit, own) in [
        (TableAngle::Gon, &["gon", "gons"][..]),
        (TableAngle::Degrees, &["deg", "degree", "degrees"]),
        (TableAngle::Radians, &["rad", "radian", "radians"]),
    ] {
        if words(&named).any(|word| own.contains(&word)) {
            return unit;
        }
    }
    if named.contains('°') {
        return TableAngle::Degrees;
    }
    let largest = numbers(azimuths).into_iter().map(f64::abs).fold(0.0, f64::max);
    match median(numbers(verticals)) {
        Some(vertical) if vertical.abs() > 95.0 => TableAngle::Gon,
        Some(vertical) if vertical.abs() > PI => TableAngle::Degrees,
        _ if largest > 360.0 => TableAngle::Gon,
        _ if largest > 2.0 * PI => TableAngle::Degrees,
        _ => TableAngle::Radians,
    }
}

/// Suggests the vertical angle: prisms are near the horizon, so angles near 0 are elevations.
fn vertical_angle(texts: &[String], unit: TableAngle) -> VerticalAngle {
    let right_angle = match unit {
        TableAngle::Radians => PI / 2.0,
        TableAngle::Degrees | TableAngle::DegreesMinutesSeconds => 90.0,
        TableAngle::Gon => 100.0,
    };
    // The first number of degrees, minutes and seconds is the degrees.
    let leading = |text: &String| {
        let end = text.find(|c: char| !c.is_ascii_digit() && !"+-.e".contains(c));
        text[..end.unwrap_or(text.len())].parse::<f64>().ok()
    };
    match median(texts.iter().filter_map(leading)) {
        Some(middle) if middle.abs() < right_angle / 2.0 => VerticalAngle::Elevation,
        _ => VerticalAngle::Zenith,
    }
}

fn length_unit(name: &str, values: &[f64]) -> TableLength {
    let name = name.to_lowercase();
    let named = |unit: &str| words(&name).any(|word| word == unit);
    let middle = median(values.iter().map(|value| value.abs())).unwrap_or(0.0);
    if named("mm") || middle > 2_000.0 {
        TableLength::Millimetres
    } else if named("ftus") || named("usft") {
        TableLength::UsSurveyFeet
    } else if named("ft") || named("feet") {
        TableLength::Feet
    } else {
        TableLength::Metres
    }
}
