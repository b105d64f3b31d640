//! Tables of poses: TUM, EuRoC, ROS exports, and CSV with a header. One pose per row.
//!
//! Columns are named by a header, which may be a comment. Without one, only formats of a fixed layout are read: TUM, positions with
//! times, EuRoC, and `ros2 topic echo --csv`. Their quaternions must have unit length, otherwise a header is asked for.

use std::borrow::Cow;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::pose_covariance::CovarianceColumns;
use super::pose_stamps::{self, Stamp, TimeColumns, plain_name, unit_of_time};
use super::table::{self, header_line, number, uncommented};
use crate::error::OpenError;
use crate::skipped_rows::SkippedRows;
use resect_tools::estimates::{EstimatedPose, PoseCovariance};

/// Largest difference of a quaternion's length from one; larger ones are reported.
const ROUNDED: f64 = 1e-2;
/// Least share of unit quaternions by which a layout without a header is accepted.
const UNIT_SHARE: f64 = 0.9;
/// Largest coordinate (m).
pub const LARGEST_M: f64 = 1e12;
pub const FORMATS: &str = "give TUM (time x y z qx qy qz qw), EuRoC, KITTI with times.txt, CSV with the columns \
                       timestamp, x, y, z and optionally qx, qy, qz, qw, or a bag with Odometry, PoseStamped or /tf";
const NAME_THE_COLUMNS: &str =
    "name the columns in a first line, such as timestamp,x,y,z,qx,qy,qz,qw";

/// Indices of the columns of a pose.
#[derive(Clone, Debug, PartialEq, Eq)]
struct PoseColumns {
    time: TimeColumns,
    position: [usize; 3],
    /// x, y, z, w.
    orientation: Option<[usize; 4]>,
    covariance: Option<CovarianceColumns>,
}

/// Layout of a table: the columns, and their source.
#[derive(Debug)]
pub struct PoseLayout {
    columns: PoseColumns,
    separator: char,
    /// Line of the header (1 is the first), or 0 without one.
    header_line: usize,
    /// Fields of the header; `None` if it is a comment, or without one.
    header_fields: Option<usize>,
    /// Name of a layout without a header.
    guessed: Option<&'static str>,
}

/// The poses of a table.
#[derive(Debug)]
pub struct PoseTable {
    /// Each pose with its covariance, if the table states it.
    pub poses: Vec<(EstimatedPose, Option<PoseCovariance>)>,
    /// Number of quaternions without unit length, which were normalised.
    pub rough_quaternions: usize,
    pub skipped: SkippedRows,
    pub guessed: Option<&'static str>,
    /// True if seconds and nanoseconds were joined without leading zeros, which is corrected.
    pub are_joined: bool,
}

/// Returns the layout of a text that begins with `head`, or the line and the reason why it is no table of poses.
pub fn layout(head: &str) -> Result<PoseLayout, (usize, String)> {
    if let Some(header) = header_line(head, |line| named(uncommented(line)).is_some()) {
        let names = uncommented(header);
        let columns = named(names).expect("the header has been found by its names");
        let separator = table::separator(names);
        let is_comment = header.trim_start().starts_with('#');
        let line = head.lines().position(|line| line == header).map_or(0, |index| index + 1);
        let count = table::fields(names, separator).map_or(0, |names| names.len());
        let header_fields = (!is_comment).then_some(count);
        return Ok(PoseLayout {
            columns,
            separator,
            header_line: line,
            header_fields,
            guessed: None,
        });
    }
    let Some((line, first)) = data_lines(head).next() else {
        return Err((0, "no pose in this file".to_owned()));
    };
    let separator = table::separator(first);
    let fields = table::fields(first, separator).map_err(|what| (line, what))?;
    let (columns, guessed) = without_header(&fields, separator).map_err(|what| (line, what))?;
    Ok(PoseLayout { columns, separator, header_line: 0, header_fields: None, guessed })
}

/// Returns true if a header has the columns of poses.
pub fn names_poses(header: &str) -> bool {
    named(header).is_some()
}

impl PoseLayout {
    /// Returns true if the poses have orientations; a table of positions alone may equally be a track.
    pub fn has_orientations(&self) -> bool {
        self.columns.orientation.is_some()
    }

    /// Returns true if the first rows have unit quaternions.
    pub fn has_unit_quaternions(&self, head: &str) -> bool {
        let lines = data_lines(head).filter(|(line, _)| *line > self.header_line).take(5);
        let rows = lines.filter_map(|(_, line)| table::fields(line, self.separator).ok());
        let poses: Vec<_> =
            rows.filter_map(|fields| self.columns.pose(&fields, self.separator).ok()).collect();
        poses.iter().all(|pose| (pose.quaternion_length - 1.0).abs() < ROUNDED)
    }
}

/// Returns the lines that are neither blank nor comments, with their numbers.
fn data_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    lines.filter(|(_, line)| {
        !line.is_empty() && !line.starts_with(['#', '%']) && !line.starts_with("sep=")
    })
}

/// Reads a whole table.
///
/// # Errors
/// If the rows that are not poses outnumber the others, or if most quaternions of a guessed layout have no unit length.
pub fn read(file: &str, text: &str) -> Result<PoseTable, OpenError> {
    let layout = layout(text).map_err(|(line, what)| match line {
        0 => OpenError::file(file, what, FORMATS),
        line => OpenError::line(file, line, what, NAME_THE_COLUMNS),
    })?;
    let (mut rows, mut skipped) = (Vec::new(), SkippedRows::default());
    let mut count = None;
    for (line, row) in data_lines(text).filter(|(line, _)| *line > layout.header_line) {
        match layout.row(row, &mut count) {
            Ok(row) => rows.push(row),
            Err(reason) => skipped.add(line, reason),
        }
    }
    skipped.refuse_if_most(file, rows.len(), table::CORRECT)?;
    let rough = rows.iter().filter(|row| (row.quaternion_length - 1.0).abs() > ROUNDED).count();
    if layout.guessed.is_some() && rough as f64 > (1.0 - UNIT_SHARE) * rows.len() as f64 {
        let what = "the columns have no header, and where a quaternion is expected are no unit quaternions";
        return Err(OpenError::file(file, what, NAME_THE_COLUMNS));
    }
    let stamps = rows.iter().map(|row| row.stamp).collect();
    let (times_s, are_joined) = pose_stamps::times_s(layout.columns.time, stamps);
    let pose = |(row, time_s): (PoseRow, f64)| {
        let pose =
            EstimatedPose { time_s, position_m: row.position_m, orientation: row.orientation };
        (pose, row.covariance)
    };
    let poses = rows.into_iter().zip(times_s).map(pose).collect();
    Ok(PoseTable { poses, rough_quaternions: rough, skipped, guessed: layout.guessed, are_joined })
}

/// One row of a table.
struct PoseRow {
    stamp: Stamp,
    position_m: Vector3<f64>,
    orientation: Option<UnitQuaternion<f64>>,
    /// Length before normalisation; 1 without an orientation.
    quaternion_length: f64,
    covariance: Option<PoseCovariance>,
}

impl PoseLayout {
    /// Returns the pose of a row, or the reason why it is not one. All rows have as many fields as the first.
    fn row(&self, row: &str, count: &mut Option<usize>) -> Result<PoseRow, String> {
        let mut fields = table::fields(row, self.separator)?;
        if self.header_fields == Some(fields.len() - 1)
            && fields.last().is_some_and(|last| last.is_empty())
        {
            fields.pop();
        }
        let expected = *count.get_or_insert(fields.len());
        if fields.len() != expected {
            return Err(format!(
                "{} fields where others have {expected}; the line may be cut short",
                fields.len()
            ));
        }
        match self.header_fields {
            Some(names) if fields.len() > names => Err(format!(
                "{} fields where the header has {names}; a column of row numbers has no name",
                fields.len()
            )),
            _ => self.columns.pose(&fields, self.separator),
        }
    }
}

impl PoseColumns {
    fn pose(&self, fields: &[Cow<'_, str>], separator: char) -> Result<PoseRow, String> {
        let field = |column: usize| {
            fields
                .get(column)
                .map(AsRef::as_ref)
                .ok_or_else(|| format!("only {} fields", fields.len()))
        };
        let value = |column: usize| -> Result<f64, String> {
            let field = field(column)?;
            match number(field, separator != ',') {
                Ok(value) if value.is_finite() => Ok(value),
                _ => Err(format!("`{}` is not a number", table::shown(field))),
            }
        };
        let stamp = self.time.stamp(fields, separator)?;
        let [x, y, z] = self.position;
        let position_m = Vector3::new(value(x)?, value(y)?, value(z)?);
        if position_m.amax() > LARGEST_M {
            return Err("the position is farther away than any planet".to_owned());
        }
        let covariance = match &self.covariance {
            Some(columns) => columns.covariance(fields, separator)?,
            None => None,
        };
        let Some([x, y, z, w]) = self.orientation else {
            let quaternion_length = 1.0;
            return Ok(PoseRow {
                stamp,
                position_m,
                orientation: None,
                quaternion_length,
                covariance,
            });
        };
        let raw = Quaternion::new(value(w)?, value(x)?, value(y)?, value(z)?);
        let quaternion_length = raw.norm();
        if quaternion_length < 1e-3 {
            return Err("the quaternion is zero".to_owned());
        }
        let orientation = Some(UnitQuaternion::from_quaternion(raw));
        Ok(PoseRow { stamp, position_m, orientation, quaternion_length, covariance })
    }
}

/// Returns the columns by the names in a header; `None` without time or position.
fn named(header: &str) -> Option<PoseColumns> {
    let names = table::fields(header, table::separator(header)).ok()?;
    let units: Vec<Option<u32>> = names.iter().map(|name| unit_of_time(name)).collect();
    let names: Vec<String> = names.iter().map(|name| plain_name(name)).collect();
    let find = |wanted: &str| names.iter().position(|name| name == wanted);
    let axis = |prefixes: &[&str], axis: &str| {
        prefixes.iter().find_map(|prefix| find(&format!("{prefix}{axis}")))
    };
    const POSITION: [&str; 13] = [
        "",
        "t",
        "p",
        "p_",
        "t_",
        "pos_",
        "position_",
        "translation_",
        "p_rs_r_",
        "pose_position_",
        "pose_pose_position_",
        "transform_translation_",
        "point_",
    ];
    const ORIENTATION: [&str; 10] = [
        "q",
        "q_",
        "q_rs_",
        "quat_",
        "orientation_",
        "rotation_",
        "pose_orientation_",
        "pose_pose_orientation_",
        "transform_rotation_",
        "quaternion_",
    ];
    let time = TimeColumns::named(&find, &units)?;
    let position = match ["x", "y", "z"].map(|name| axis(&POSITION, name)) {
        [Some(x), Some(y), Some(z)] => [x, y, z],
        _ => map_coordinates(&find)?,
    };
    let orientation = match ["x", "y", "z", "w"].map(|name| axis(&ORIENTATION, name)) {
        [Some(x), Some(y), Some(z), Some(w)] => Some([x, y, z, w]),
        _ => None,
    };
    let covariance = CovarianceColumns::named(&find);
    Some(PoseColumns { time, position, orientation, covariance })
}

/// Returns the columns of map coordinates: east, north and height.
fn map_coordinates(find: &dyn Fn(&str) -> Option<usize>) -> Option<[usize; 3]> {
    const EAST_NORTH: [[&str; 2]; 3] = [["easting", "northing"], ["east", "north"], ["e", "n"]];
    const HEIGHTS: [&str; 7] = ["elevation", "height", "up", "altitude", "u", "h", "z"];
    let (east, north) =
        EAST_NORTH.into_iter().find_map(|[east, north]| find(east).zip(find(north)))?;
    Some([east, north, HEIGHTS.into_iter().find_map(find)?])
}

/// Returns the columns of a row without a header, and the name of the layout unless it is TUM's or positions.
fn without_header(
    fields: &[Cow<'_, str>],
    separator: char,
) -> Result<(PoseColumns, Option<&'static str>), String> {
    let numbers: Vec<Option<f64>> =
        fields.iter().map(|field| number(field, separator != ',').ok()).collect();
    let at = |time, first: usize, orientation: Option<[usize; 4]>| PoseColumns {
        time,
        position: [first, first + 1, first + 2],
        orientation,
        covariance: None,
    };
    let one = TimeColumns::One(0, None);
    let pair = TimeColumns::SecondsAndNanoseconds(0, 1);
    let is_text = |index: usize| numbers.get(index).is_some_and(Option::is_none);
    let are_numbers =
        |from: usize| numbers.len() > from && numbers[from..].iter().all(Option::is_some);
    let is_nanoseconds = numbers.first().copied().flatten().is_some_and(|t| t.abs() > 1e15);
    let count = match fields.last() {
        Some(last) if last.is_empty() => fields.len() - 1,
        _ => fields.len(),
    };
    let quaternion_from = |first: usize| Some([first, first + 1, first + 2, first + 3]);
    Ok(match count {
        8 | 17 if separator == ',' && is_nanoseconds && are_numbers(1) => {
            (at(one, 1, Some([5, 6, 7, 4])), Some("EuRoC: time, x, y, z, qw, qx, qy, qz"))
        }
        8 if are_numbers(1) => (at(one, 1, quaternion_from(4)), None),
        4 if are_numbers(1) => (at(one, 1, None), None),
        10.. if separator == ',' && is_text(2) && !is_text(3) => (
            at(pair, 3, quaternion_from(6)),
            Some("ros2 topic echo --csv: sec, nanosec, frame, pose"),
        ),
        11.. if separator == ',' && is_text(2) && is_text(3) => (
            at(pair, 4, quaternion_from(7)),
            Some("ros2 topic echo --csv: sec, nanosec, frames, pose"),
        ),
        6 if separator == ',' && is_text(2) && !is_text(3) => {
            (at(pair, 3, None), Some("ros2 topic echo --csv: sec, nanosec, frame, point"))
        }
        _ if is_text(0) => {
            return Err(format!(
                "the header `{}` has no columns of poses",
                shown_row(fields, separator)
            ));
        }
        count => return Err(format!("{count} fields without a header do not form a pose")),
    })
}

fn shown_row(fields: &[Cow<'_, str>], separator: char) -> String {
    table::shown(&fields.join(&separator.to_string()))
}
