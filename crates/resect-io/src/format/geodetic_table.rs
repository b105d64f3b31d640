//! Tables with latitude, longitude and height: one position per row, below a header.
//!
//! Names are those of ROS exports, receivers and spreadsheets: `latitude`, `lat_deg`, `lon [rad]`, `field.altitude`, `gps/fix/latitude`. Angles
//! are degrees and heights metres unless the header names another unit. Orientations of such tables are not read: they have no common frame.

use std::borrow::Cow;

use super::column_units::{angle_unit_rad, length_unit_m, without_unit};
use super::nav_sat_fix::{FixCovariance, forget_constant_single, kind_of_status};
use super::pose_stamps::{Stamp, TimeColumns, times_s};
use super::pose_table;
use super::table::{self, CORRECT, header_line, number, row_fields, uncommented};
use crate::error::OpenError;
use crate::findings::gnss::{gnss_column_not_read, gnss_sigma_approximated};
use crate::findings::tracks::rows_skipped;
use crate::findings::trajectories::estimate_stamps_joined;
use crate::gnss_solution::{
    GnssSolution, GnssTrack, SolutionKind, SolutionPosition, covariance_of_roots,
    geodetic_of_degrees,
};
use crate::skipped_rows::SkippedRows;
use resect_core::deployment::Finding;
use resect_core::geometry::Geodetic;

const LATITUDES: [&str; 2] = ["latitude", "lat"];
const LONGITUDES: [&str; 4] = ["longitude", "lon", "long", "lng"];
const HEIGHTS: [&str; 12] = [
    "ellipsoidal_height",
    "ellipsoid_height",
    "height_ellipsoid",
    "hae",
    "height",
    "altitude",
    "alt",
    "hgt",
    "h",
    "elevation",
    "ele",
    "msl",
];
/// Words in the names of columns that are not positions, although they end like them.
const NOT_POSITIONS: [&str; 8] =
    ["antenna", "sigma", "std", "rms", "accuracy", "error", "cov", "undulation"];
const KINDS: [&str; 10] = [
    "solution_status",
    "sol_status",
    "solution",
    "fix_quality",
    "fix_type",
    "fix",
    "quality",
    "gps_qual",
    "q",
    "status",
];
const ORIENTATIONS: [&str; 6] = ["qx", "q_x", "orientation_x", "roll", "yaw", "heading"];
const NAME_THE_COLUMNS: &str =
    "name the columns in a first line, such as timestamp,latitude,longitude,height";

/// A column, with the factor that converts its numbers to radians or metres.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ScaledColumn {
    index: usize,
    factor: f64,
}

/// Names of a header: without units in lower case, and as they stand there.
struct ColumnNames(Vec<(String, String)>);

/// Columns of σ or of a covariance.
#[derive(Clone, Debug, PartialEq)]
enum ErrorColumns {
    /// East, north, up.
    Sigmas([ScaledColumn; 3]),
    /// Nine elements, and the type.
    Message([usize; 9], usize),
}

/// Column of the kind of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
enum KindColumn {
    /// Words such as `FIX` and `FLOAT`.
    Words(usize),
    /// Status of `NavSatFix`.
    Status(usize),
}

/// Indices of the columns of a table.
#[derive(Clone, Debug)]
struct GeodeticColumns {
    time: TimeColumns,
    /// Latitude, longitude, height.
    position: [ScaledColumn; 3],
    errors: Option<ErrorColumns>,
    kind: Option<KindColumn>,
}

/// Content of a row.
struct GeodeticRow {
    stamp: Stamp,
    /// `None` without a fix.
    position: Option<(Geodetic, SolutionKind)>,
    covariance: FixCovariance,
}

/// Returns true if the header of a table has latitude and longitude, and no positions in metres.
pub fn looks_like(head: &str) -> bool {
    header(head).is_some()
}

fn header(text: &str) -> Option<&str> {
    let is_header = |line: &str| {
        let names = uncommented(line);
        ColumnNames::of(names).is_ok_and(|names| names.has_angles())
            && !pose_table::names_poses(names)
    };
    header_line(text, is_header)
}

impl ColumnNames {
    fn of(header: &str) -> Result<Self, String> {
        let names = table::fields(header, table::separator(header))?;
        Ok(Self(names.iter().map(|name| (without_unit(name), name.to_string())).collect()))
    }

    fn has_angles(&self) -> bool {
        self.position_of(&LATITUDES).is_some() && self.position_of(&LONGITUDES).is_some()
    }

    fn find(&self, wanted: &str) -> Option<usize> {
        self.0.iter().position(|(name, _)| name == wanted)
    }

    /// Finds a column of positions by its whole name, otherwise by the end of it.
    fn position_of(&self, wanted: &[&str]) -> Option<usize> {
        let is_position = |name: &str| !NOT_POSITIONS.iter().any(|word| name.contains(word));
        let ends = |name: &str, wanted: &str| {
            name.strip_suffix(wanted).is_some_and(|rest| rest.ends_with('_'))
        };
        let by_end = |wanted: &&str| {
            self.0.iter().position(|(name, _)| is_position(name) && ends(name, wanted))
        };
        wanted.iter().find_map(|name| self.find(name)).or_else(|| wanted.iter().find_map(by_end))
    }

    /// Column of an angle, in degrees unless its name has another unit.
    fn angle(&self, index: usize) -> Result<ScaledColumn, String> {
        let unit_rad = angle_unit_rad(&self.0[index].1)?;
        Ok(ScaledColumn { index, factor: unit_rad.unwrap_or(std::f64::consts::PI / 180.0) })
    }

    fn length(&self, index: usize) -> Result<ScaledColumn, String> {
        Ok(ScaledColumn { index, factor: length_unit_m(&self.0[index].1)? })
    }

    /// Finds three columns of σ, along east, north and up.
    fn sigmas(&self) -> Option<Result<ErrorColumns, String>> {
        const AXES: [[&str; 3]; 7] = [
            ["e", "n", "u"],
            ["east", "north", "up"],
            ["easting", "northing", "elevation"],
            ["lon", "lat", "alt"],
            ["lon", "lat", "height"],
            ["longitude", "latitude", "altitude"],
            ["longitude", "latitude", "height"],
        ];
        const WORDS: [&str; 5] = ["sigma", "std", "stddev", "sd", "rms"];
        let indices = AXES.iter().find_map(|axes| {
            WORDS.iter().find_map(|word| {
                let column = |axis: &str| {
                    [format!("{word}{axis}"), format!("{word}_{axis}"), format!("{axis}_{word}")]
                        .iter()
                        .find_map(|name| self.find(name))
                };
                Some([column(axes[0])?, column(axes[1])?, column(axes[2])?])
            })
        })?;
        let columns = indices.map(|index| self.length(index));
        let [east, north, up] = columns;
        Some((|| Ok(ErrorColumns::Sigmas([east?, north?, up?])))())
    }

    fn message_covariance(&self) -> Option<ErrorColumns> {
        let covariance_type = self.find("position_covariance_type")?;
        let mut elements = [0; 9];
        for (index, element) in elements.iter_mut().enumerate() {
            *element = ["position_covariance", "position_covariance_"]
                .iter()
                .find_map(|name| self.find(&format!("{name}{index}")))?;
        }
        Some(ErrorColumns::Message(elements, covariance_type))
    }
}

impl GeodeticColumns {
    /// Returns the columns by their names; the error is a sentence without the file.
    fn named(header: &str) -> Result<Self, String> {
        let fields = table::fields(header, table::separator(header))?;
        let headers: Vec<&str> = fields.iter().map(AsRef::as_ref).collect();
        let names = ColumnNames::of(header)?;
        let position = |wanted: &[&str]| {
            names
                .position_of(wanted)
                .ok_or_else(|| format!("the header has no column {}", wanted[0]))
        };
        let position = [
            names.angle(position(&LATITUDES)?)?,
            names.angle(position(&LONGITUDES)?)?,
            names.length(
                position(&HEIGHTS).map_err(|_| "the header has no column height".to_owned())?,
            )?,
        ];
        let time = TimeColumns::named(&headers)?.ok_or("the header has no column of times")?;
        let errors = match names.message_covariance() {
            Some(columns) => Some(columns),
            None => names.sigmas().transpose()?,
        };
        let status = names.find("status_status").map(KindColumn::Status);
        let words = || KINDS.iter().find_map(|name| names.find(name)).map(KindColumn::Words);
        Ok(Self { time, position, errors, kind: status.or_else(words) })
    }

    fn row(&self, fields: &[Cow<'_, str>], separator: char) -> Result<GeodeticRow, String> {
        let value = |index: usize| {
            number(&fields[index], separator != ',')
                .map_err(|what| format!("`{}` {what}", table::shown(&fields[index])))
        };
        let stamp = self.time.stamp(fields, separator)?;
        let kind = match self.kind {
            None => Some(SolutionKind::Unstated),
            Some(KindColumn::Words(index)) => kind_of_word(&fields[index]),
            Some(KindColumn::Status(index)) => kind_of_status(value(index)? as i64),
        };
        let [latitude, longitude, height] = self.position;
        let (latitude_rad, longitude_rad) =
            (latitude.factor * value(latitude.index)?, longitude.factor * value(longitude.index)?);
        let is_unset = latitude_rad.is_nan() || (latitude_rad, longitude_rad) == (0.0, 0.0);
        let Some(kind) = kind.filter(|_| !is_unset) else {
            return Ok(GeodeticRow { stamp, position: None, covariance: FixCovariance::Unknown });
        };
        let height_m = height.factor * value(height.index)?;
        let degrees = [latitude_rad.to_degrees(), longitude_rad.to_degrees()];
        let geodetic = geodetic_of_degrees(degrees[0], degrees[1], height_m).ok_or_else(|| {
            format!(
                "latitude {}, longitude {} and height {} are not on the Earth in the units of the header",
                fields[latitude.index], fields[longitude.index], fields[height.index]
            )
        })?;
        let covariance = match &self.errors {
            None => FixCovariance::Unknown,
            Some(ErrorColumns::Sigmas(columns)) => {
                let mut sigma_m = [0.0; 3];
                for (sigma_m, column) in sigma_m.iter_mut().zip(columns) {
                    *sigma_m = column.factor * value(column.index)?;
                }
                covariance_of_roots(sigma_m, [0.0; 3])
                    .map_or(FixCovariance::Unknown, FixCovariance::Known)
            }
            Some(ErrorColumns::Message(columns, covariance_type)) => {
                let mut elements_m2 = [0.0; 9];
                for (element_m2, index) in elements_m2.iter_mut().zip(columns) {
                    *element_m2 = value(*index)?;
                }
                FixCovariance::of_elements(&elements_m2, value(*covariance_type)? as u8)
            }
        };
        let geodetic = Geodetic { latitude_rad, longitude_rad, ..geodetic };
        Ok(GeodeticRow { stamp, position: Some((geodetic, kind)), covariance })
    }
}

/// Returns the kind of a solution by a receiver's word; `None` for no solution.
fn kind_of_word(word: &str) -> Option<SolutionKind> {
    let word = word.to_lowercase();
    let has = |others: &[&str]| others.iter().any(|other| word.contains(other));
    if has(&["none", "no fix", "no_fix", "nofix", "invalid", "insufficient"]) {
        return None;
    }
    Some(if has(&["float"]) {
        SolutionKind::Float
    } else if has(&["2d", "3d", "single", "autonomous", "spp"]) {
        SolutionKind::Single
    } else if has(&["dgps", "dgnss", "sbas", "waas", "diff"]) {
        SolutionKind::Differential
    } else if has(&["ppp"]) {
        SolutionKind::Ppp
    } else if has(&["dead", "estimated"]) {
        SolutionKind::NotMeasured
    } else if has(&["fix", "narrow_int", "wide_int", "l1_int"]) {
        SolutionKind::Fixed
    } else {
        SolutionKind::Unstated
    })
}

/// Reads a whole table.
///
/// # Errors
/// If a column is missing or has an unknown unit, or if the rows that are not positions outnumber the others.
pub fn read(file: &str, text: &str) -> Result<GnssTrack, OpenError> {
    let Some(header) = header(text) else {
        return Err(OpenError::file(file, "no columns latitude and longitude", NAME_THE_COLUMNS));
    };
    let header_line = text.lines().position(|line| line == header).map_or(0, |index| index + 1);
    let names = uncommented(header);
    let mut columns = GeodeticColumns::named(names)
        .map_err(|what| OpenError::line(file, header_line, what, NAME_THE_COLUMNS))?;
    let separator = table::separator(names);
    let count = table::fields(names, separator).map_or(0, |names| names.len());
    let lines = text.lines().enumerate().skip(header_line);
    let lines: Vec<(usize, &str)> = lines
        .map(|(index, line)| (index + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with(['#', '%']))
        .collect();
    let mut findings = Vec::new();
    if let Some(KindColumn::Words(index)) = columns.kind {
        let is_number = |(_, line): &(usize, &str)| {
            let fields = row_fields(line, separator, count);
            fields.is_ok_and(|fields| number(&fields[index], false).is_ok())
        };
        if lines.iter().any(is_number) {
            let name = &ColumnNames::of(names).unwrap_or(ColumnNames(Vec::new())).0[index].0;
            let reason =
                "the numbers of qualities differ between receivers; write fixed, float or single";
            findings.push(gnss_column_not_read(file, name, reason));
            columns.kind = None;
        }
    }
    let orientation = ColumnNames::of(names).ok().and_then(|names| {
        ORIENTATIONS.iter().find_map(|name| names.find(name)).map(|index| names.0[index].0.clone())
    });
    findings.extend(orientation.map(|name| {
        gnss_column_not_read(
            file,
            &name,
            "orientations beside latitude and longitude have no common frame",
        )
    }));
    let (mut rows, mut skipped) = (Vec::new(), SkippedRows::default());
    for (line, row) in lines {
        match row_fields(row, separator, count).and_then(|fields| columns.row(&fields, separator)) {
            Ok(row) => rows.push(row),
            Err(reason) => skipped.add(line, reason),
        }
    }
    skipped.refuse_if_most(file, rows.len(), CORRECT)?;
    findings.extend(rows_skipped(file, &skipped));
    Ok(into_track(file, columns.time, rows, findings))
}

fn into_track(
    file: &str,
    time: TimeColumns,
    rows: Vec<GeodeticRow>,
    mut findings: Vec<Finding>,
) -> GnssTrack {
    let stamps = rows.iter().map(|row| row.stamp).collect();
    let (times_s, are_joined) = times_s(time, stamps);
    if are_joined {
        findings.push(estimate_stamps_joined(file));
    }
    let mut track = GnssTrack::default();
    let mut approximated = 0;
    for (row, time_s) in rows.into_iter().zip(times_s) {
        let Some((geodetic, kind)) = row.position else {
            track.without_fix += 1;
            continue;
        };
        approximated += usize::from(row.covariance == FixCovariance::Approximated);
        let covariance_m2 = match row.covariance {
            FixCovariance::Known(covariance_m2) => Some(covariance_m2),
            FixCovariance::Approximated | FixCovariance::Unknown => None,
        };
        let position = SolutionPosition::Geodetic(geodetic);
        track.solutions.push(GnssSolution { time_s, position, kind, covariance_m2 });
    }
    forget_constant_single(&mut track.solutions);
    if approximated > 0 {
        findings.push(gnss_sigma_approximated(file, approximated));
    }
    GnssTrack { findings, ..track }
}

#[cfg(test)]
mod tests;
