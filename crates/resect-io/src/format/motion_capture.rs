//! Exports of motion capture as CSV: rigid bodies and markers of OptiTrack's Motive, trajectories, segments and objects of Vicon.
//!
//! Several rows name the columns: the body, the kind of number, the axis. Motive states the unit in its first line and times in seconds; Vicon
//! states units below the axes and the rate above them. Times count from the first frame, because the start of a capture has no time zone.
//!
//! Quaternions are read. Angles about axes are not, because neither file states their order. Written after published exports (Motive 1.9 to 3,
//! Nexus 2); not tested on an export of one's own.

use std::borrow::Cow;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::table::{self, number};
use crate::error::OpenError;
use crate::skipped_rows::SkippedRows;
use resect_tools::estimates::EstimatedPose;

/// Largest difference of a quaternion's length from one; larger ones are errors.
const ROUNDED: f64 = 1e-2;
/// Metres of one unit of length.
const LENGTHS: [(&str, f64); 10] = [
    ("m", 1.0),
    ("meters", 1.0),
    ("metres", 1.0),
    ("cm", 0.01),
    ("centimeters", 0.01),
    ("mm", 1e-3),
    ("millimeters", 1e-3),
    ("millimetres", 1e-3),
    ("inches", 0.0254),
    ("feet", 0.3048),
];

/// Poses of a body or positions of a marker.
#[derive(Debug)]
pub struct CapturedBody {
    pub name: String,
    pub poses: Vec<EstimatedPose>,
    /// Frames in which it was not tracked, or with numbers that are not valid.
    pub skipped: SkippedRows,
    /// True if the file has angles about axes, which are not read.
    pub has_angles: bool,
}

/// Columns of a body.
#[derive(Debug, PartialEq)]
struct BodyColumns {
    name: String,
    is_marker: bool,
    position: [usize; 3],
    /// x, y, z, w.
    quaternion: Option<[usize; 4]>,
    has_angles: bool,
}

/// Times of the rows.
#[derive(Clone, Copy, Debug, PartialEq)]
enum FrameTimes {
    /// The second column has seconds.
    Seconds,
    /// Frames per second.
    Rate(f64),
}

/// The rows that name the columns.
#[derive(Debug)]
struct CaptureHead {
    /// Index of the line with the axes.
    line: usize,
    separator: char,
    times: FrameTimes,
    metres_per_unit: f64,
    bodies: Vec<BodyColumns>,
}

/// Returns true for the beginning of an export.
pub fn looks_like(head: &str) -> bool {
    head.lines().take(table::LINES_ABOVE).any(is_axes)
}

/// Returns true for the line with the axes.
fn is_axes(line: &str) -> bool {
    let separator = table::separator(line);
    let Ok(fields) = table::fields(line, separator) else { return false };
    let [frame, second, axes @ ..] = &fields[..] else { return false };
    let is_second =
        second.eq_ignore_ascii_case("sub frame") || second.to_ascii_lowercase().starts_with("time");
    let has = |name: &str| axes.iter().any(|axis| axis.eq_ignore_ascii_case(name));
    frame.eq_ignore_ascii_case("frame") && is_second && (has("z") || has("tz"))
}

/// Reads the bodies of an export; without any, its markers.
///
/// # Errors
/// If the unit or the rate is missing, or if nothing was tracked.
pub fn read(file: &str, text: &str) -> Result<Vec<CapturedBody>, OpenError> {
    let lines: Vec<&str> = text.lines().collect();
    let head = CaptureHead::of(&lines).map_err(|(line, what)| {
        OpenError::line(file, line + 1, what, "export the capture again with its header")
    })?;
    let mut bodies: Vec<CapturedBody> =
        head.bodies.iter().map(BodyColumns::without_poses).collect();
    for (index, line) in lines.iter().enumerate().skip(head.line + 1) {
        let Ok(fields) = table::fields(line, head.separator) else { continue };
        let is_frame = fields[0].parse::<u64>().is_ok();
        match (is_frame, bodies.iter().all(|body| body.poses.is_empty())) {
            (true, _) => {}
            // The row of units, or a blank row before the first frame.
            (false, true) => continue,
            // Another section follows.
            (false, false) => break,
        }
        for (columns, body) in head.bodies.iter().zip(&mut bodies) {
            match head.pose(columns, &fields) {
                Ok(pose) => body.poses.push(pose),
                Err(reason) => body.skipped.add(index + 1, reason),
            }
        }
    }
    bodies.retain(|body| !body.poses.is_empty());
    if bodies.is_empty() {
        let what = "no body or marker of this capture has a position";
        return Err(OpenError::file(file, what, "export the frames in which it was tracked"));
    }
    Ok(bodies)
}

impl BodyColumns {
    fn without_poses(&self) -> CapturedBody {
        CapturedBody {
            name: self.name.clone(),
            poses: Vec::new(),
            skipped: SkippedRows::default(),
            has_angles: self.has_angles,
        }
    }
}

impl CaptureHead {
    /// Reads the rows above and below the axes; the error has an index of a line and its fault.
    fn of(lines: &[&str]) -> Result<Self, (usize, String)> {
        let line = lines.iter().position(|line| is_axes(line));
        let line = line.ok_or((0, "no row names the axes of the columns".to_owned()))?;
        let separator = table::separator(lines[line]);
        let cells = |index: usize| table::fields(lines[index], separator).unwrap_or_default();
        let axes = cells(line);
        let is_vicon = axes[1].eq_ignore_ascii_case("sub frame");
        let row = |name: &str| {
            let named = |index: &usize| cells(*index).get(1).is_some_and(|cell| cell == name);
            (0..line).rev().find(named).map(cells)
        };
        let (times, unit) = match is_vicon {
            true => {
                let rate = (0..line).rev().find_map(|index| lone_number(&cells(index)));
                let rate_hz = rate.filter(|rate_hz| *rate_hz > 0.0);
                let rate_hz = rate_hz.ok_or((line, "no row above has the rate".to_owned()))?;
                let units = lines.get(line + 1).map(|_| cells(line + 1)).unwrap_or_default();
                let column = axes.iter().position(|axis| is_axis(axis, "z"));
                let unit = column.and_then(|column| units.get(column)).map(ToString::to_string);
                (FrameTimes::Rate(rate_hz), unit)
            }
            false => {
                let first = lines.first().map(|_| cells(0)).unwrap_or_default();
                let key = first.iter().position(|cell| cell == "Length Units");
                let unit = key.and_then(|key| first.get(key + 1)).map(ToString::to_string);
                (FrameTimes::Seconds, unit)
            }
        };
        let unit = unit.unwrap_or_default().to_lowercase();
        let factor = LENGTHS.iter().find(|(word, _)| *word == unit).map(|(_, factor)| *factor);
        let metres_per_unit = factor.ok_or_else(|| {
            (line, format!("the unit of lengths `{}` is not known", table::shown(&unit)))
        })?;
        let names = match is_vicon {
            true => filled(line.checked_sub(1).map(cells).unwrap_or_default(), axes.len()),
            false => row("Name").ok_or((line, "no row above has the names".to_owned()))?,
        };
        let kinds =
            if is_vicon { Vec::new() } else { line.checked_sub(1).map(cells).unwrap_or_default() };
        let types = if is_vicon { None } else { row("Type") };
        let bodies = bodies(&axes, &names, &kinds, types.as_deref());
        Ok(Self { line, separator, times, metres_per_unit, bodies })
    }

    /// Returns the pose of a body in a row, or the reason why there is none.
    fn pose(
        &self,
        columns: &BodyColumns,
        fields: &[Cow<'_, str>],
    ) -> Result<EstimatedPose, String> {
        let value = |index: usize| match fields.get(index).map(AsRef::as_ref) {
            None | Some("") => Err(format!("{} is not tracked", table::shown(&columns.name))),
            Some(field) => number(field, self.separator != ',')
                .ok()
                .filter(|value| value.is_finite())
                .ok_or_else(|| format!("`{}` is not a number", table::shown(field))),
        };
        let time_s = match self.times {
            FrameTimes::Seconds => value(1)?,
            FrameTimes::Rate(rate_hz) => value(0)? / rate_hz,
        };
        let [x, y, z] = columns.position;
        let position_m = Vector3::new(value(x)?, value(y)?, value(z)?) * self.metres_per_unit;
        let orientation = match columns.quaternion {
            None => None,
            Some([x, y, z, w]) => {
                let quaternion = Quaternion::new(value(w)?, value(x)?, value(y)?, value(z)?);
                if (quaternion.norm() - 1.0).abs() > ROUNDED {
                    return Err("the quaternion has no unit length".to_owned());
                }
                Some(UnitQuaternion::from_quaternion(quaternion))
            }
        };
        Ok(EstimatedPose { time_s, position_m, orientation })
    }
}

/// Returns the only number of a row; `None` if it has other fields.
fn lone_number(cells: &[Cow<'_, str>]) -> Option<f64> {
    let mut filled = cells.iter().filter(|cell| !cell.is_empty());
    let number = filled.next()?.parse().ok()?;
    filled.next().is_none().then_some(number)
}

/// Repeats the name of the first column of a body in its others.
fn filled<'a>(mut names: Vec<Cow<'a, str>>, count: usize) -> Vec<Cow<'a, str>> {
    names.resize(count, Cow::Borrowed(""));
    for index in 1..names.len() {
        if names[index].is_empty() {
            names[index] = names[index - 1].clone();
        }
    }
    names
}

fn is_axis(cell: &str, axis: &str) -> bool {
    cell.eq_ignore_ascii_case(axis) || cell.eq_ignore_ascii_case(&format!("t{axis}"))
}

/// Returns the bodies of the columns; markers only if there is no body.
fn bodies(
    axes: &[Cow<'_, str>],
    names: &[Cow<'_, str>],
    kinds: &[Cow<'_, str>],
    types: Option<&[Cow<'_, str>]>,
) -> Vec<BodyColumns> {
    let cell = |cells: &[Cow<'_, str>], index: usize| -> String {
        cells.get(index).map(ToString::to_string).unwrap_or_default()
    };
    let kind_of = |index: usize| cell(types.unwrap_or_default(), index);
    let mut bodies: Vec<BodyColumns> = Vec::new();
    let mut first = 2;
    while first < axes.len() {
        let name = cell(names, first);
        let end = (first..axes.len())
            .find(|index| cell(names, *index) != name || kind_of(*index) != kind_of(first))
            .unwrap_or(axes.len());
        let column = |kind: &str, axis: &str| {
            (first..end).find(|index| {
                let is_kind = kinds.is_empty() || cell(kinds, *index) == kind;
                is_kind && is_axis(&axes[*index], axis)
            })
        };
        let quaternion = ["x", "y", "z", "w"].map(|axis| column("Rotation", axis));
        let has_angles = (first..end).any(|index| axes[index].eq_ignore_ascii_case("rx"))
            || (quaternion[0].is_some() && quaternion[3].is_none() && !kinds.is_empty());
        if let [Some(x), Some(y), Some(z)] = ["x", "y", "z"].map(|axis| column("Position", axis)) {
            let quaternion = match quaternion {
                [Some(x), Some(y), Some(z), Some(w)] => Some([x, y, z, w]),
                _ => None,
            };
            let is_marker = kind_of(first).contains("Marker");
            bodies.push(BodyColumns {
                name,
                is_marker,
                position: [x, y, z],
                quaternion,
                has_angles,
            });
        }
        first = end;
    }
    if bodies.iter().any(|body| !body.is_marker) {
        bodies.retain(|body| !body.is_marker);
    }
    bodies
}

#[cfg(test)]
mod tests;
