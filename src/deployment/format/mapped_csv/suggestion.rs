//! The best guess at what the columns of an unknown table are, from their names and their first numbers.

use std::f64::consts::PI;

use super::super::ColumnMapping;
use super::super::column_mapping::{TableAngle, TableLength, TimeFormat, VerticalAngle};
use super::values::with_point;
use super::{first_rows, separator, table};

/// Names of a column without what is not a letter or digit: whole ones, and parts of longer ones.
struct Names(&'static [&'static str], &'static [&'static str]);

const TIME: Names = Names(&["t", "s", "sec", "utc"], &["time", "stamp", "epoch", "date"]);
const STATION: Names =
    Names(&["id", "rts", "st", "station", "stationid"], &["station", "theodolite", "instrument"]);
const RANGE: Names = Names(&["d", "sd", "r"], &["distance", "range", "slope", "dist"]);
const AZIMUTH: Names = Names(
    &["ha", "hz", "az", "hr", "h", "azi"],
    &["azimuth", "horizontal", "hangle", "hzangle", "bearing"],
);
const VERTICAL: Names = Names(
    &["va", "v", "vz", "ze", "zd", "el", "elev"],
    &["zenith", "vertical", "vangle", "elevation", "altitude"],
);
const X: Names = Names(&["x", "xm", "xmm", "e", "east", "posx"], &["easting"]);
const Y: Names = Names(&["y", "ym", "ymm", "n", "north", "posy"], &["northing"]);
const Z: Names = Names(&["z", "zm", "zmm", "u", "up", "posz"], &["height"]);
const STATUS: Names = Names(&[], &["status", "returncode", "errorcode"]);

/// The mapping that a user would most likely choose for a table that begins with `head`. Columns that are not recognised
/// are left unnamed.
pub fn suggest(head: &str) -> ColumnMapping {
    let (header, rows) = first_rows(head);
    let separator = separator(&header);
    let Ok(names) = table::fields(&header, separator) else { return ColumnMapping::default() };
    let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    let rows: Vec<_> = rows.into_iter().filter_map(|(_, row)| row.ok()).collect();
    let texts = |column: Option<usize>| -> Vec<String> {
        let Some(column) = column else { return Vec::new() };
        rows.iter().map(|row| with_point(&row[column], separator != ',').into_owned()).collect()
    };

    let mut free: Vec<bool> = vec![true; names.len()];
    let mut take = |wanted: &Names| {
        let found = find(&names, &free, wanted)?;
        free[found] = false;
        Some(found)
    };
    // What is a time by its name may be several columns; what has more letters is the surer one.
    let time = take(&TIME);
    let [status, range, azimuth, vertical] = [&STATUS, &RANGE, &AZIMUTH, &VERTICAL].map(&mut take);
    let station = take(&STATION);
    let polar = range.is_some() && azimuth.is_some() && vertical.is_some();
    let [x, y, z] = if polar { [None; 3] } else { [&X, &Y, &Z].map(&mut take) };
    let cartesian = x.is_some() && y.is_some() && z.is_some();

    let angle_unit = angle_unit(&texts(azimuth), &texts(vertical));
    let lengths = if polar { range } else { x };
    let name =
        |column: Option<usize>, is: bool| column.filter(|_| is).map(|at| names[at].to_owned());
    ColumnMapping {
        time: name(time, true).unwrap_or_default(),
        time_format: time_format(&texts(time)),
        utc_offset_hours: 0.0,
        station: name(station, true),
        range: name(range, !cartesian),
        azimuth: name(azimuth, !cartesian),
        vertical: name(vertical, !cartesian),
        x: name(x, cartesian),
        y: name(y, cartesian),
        z: name(z, cartesian),
        length_unit: length_unit(lengths.map_or("", |at| names[at]), &numbers(&texts(lengths))),
        angle_unit,
        vertical_angle: vertical_angle(&texts(vertical), angle_unit),
        status: name(status, true),
    }
}

/// The free column with such a name.
fn find(names: &[&str], free: &[bool], Names(whole, parts): &Names) -> Option<usize> {
    let plain: Vec<String> = names
        .iter()
        .map(|name| name.to_lowercase().chars().filter(char::is_ascii_alphanumeric).collect())
        .collect();
    let first =
        |is: &dyn Fn(&str) -> bool| (0..names.len()).find(|at| free[*at] && is(&plain[*at]));
    // Parts in their order: the first is the most telling.
    let by_part = || parts.iter().find_map(|part| first(&|name| name.contains(part)));
    first(&|name| whole.contains(&name)).or_else(by_part)
}

fn numbers(texts: &[String]) -> Vec<f64> {
    texts
        .iter()
        .filter_map(|text| text.parse().ok())
        .filter(|value: &f64| value.is_finite())
        .collect()
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    values.sort_by(f64::total_cmp);
    Some(values[values.len() / 2])
}

fn time_format(texts: &[String]) -> TimeFormat {
    let Some(first) = texts.first() else { return TimeFormat::Seconds };
    if first.contains(':') {
        let has_date = first.contains(['T', ' ', '/']);
        return if has_date { TimeFormat::Calendar } else { TimeFormat::TimeOfDay };
    }
    let stamps = numbers(texts);
    let steps = stamps.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0);
    match (median(stamps.clone()).unwrap_or(0.0), median(steps.collect()).unwrap_or(0.0)) {
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

fn angle_unit(azimuths: &[String], verticals: &[String]) -> TableAngle {
    let is_sexagesimal =
        |text: &String| text.parse::<f64>().is_err() && text.chars().any(|c| c.is_ascii_digit());
    if verticals.first().is_some_and(is_sexagesimal) {
        return TableAngle::DegreesMinutesSeconds;
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

/// Prisms are near the horizon: angles about 0 are of elevation.
fn vertical_angle(texts: &[String], unit: TableAngle) -> VerticalAngle {
    let right_angle = match unit {
        TableAngle::Radians => PI / 2.0,
        TableAngle::Degrees | TableAngle::DegreesMinutesSeconds => 90.0,
        TableAngle::Gon => 100.0,
    };
    // Degrees are the first number of degrees, minutes and seconds.
    let leading = |text: &String| {
        let end = text.find(|c: char| !c.is_ascii_digit() && !"+-.e".contains(c));
        text[..end.unwrap_or(text.len())].parse::<f64>().ok()
    };
    match median(texts.iter().filter_map(leading).collect()) {
        Some(middle) if middle.abs() < right_angle / 2.0 => VerticalAngle::Elevation,
        _ => VerticalAngle::Zenith,
    }
}

fn length_unit(name: &str, values: &[f64]) -> TableLength {
    let name = name.to_lowercase();
    let parts: Vec<_> = name.split(|c: char| !c.is_alphanumeric()).collect();
    let named = |unit: &str| parts.contains(&unit);
    let middle = median(values.iter().map(|value| value.abs()).collect()).unwrap_or(0.0);
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
