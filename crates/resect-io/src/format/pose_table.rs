//! Tables of poses: TUM, EuRoC, ROS exports, and CSV with a header. One pose per row.
//!
//! Columns are named by a header, which may be a comment. Without one, only formats of a fixed layout are read: TUM, positions with
//! times, EuRoC, and `ros2 topic echo --csv`. Their quaternions must have unit length, otherwise a header is asked for.

use std::borrow::Cow;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::orientation_columns::{
    GuessedAngleUnit, OrientationColumns, contradicted_angle_unit, from_roll_pitch_yaw,
    guessed_angle_unit,
};
use super::pose_columns::{PoseColumns, is_header, named, without_header};
use super::pose_stamps::{self, Stamp};
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
    /// Meaning of columns that their names leave open, and names of columns that are not read.
    pub column_guesses: Vec<&'static str>,
    pub unread_columns: Vec<String>,
    /// Unit of roll, pitch and yaw, if no name states it.
    pub angle_unit: Option<GuessedAngleUnit>,
}

/// Returns the layout of a text that begins with `head`, or the line and the reason why it is no table of poses.
pub fn layout(head: &str) -> Result<PoseLayout, (usize, String)> {
    if let Some(header) = header_line(head, |line| is_header(uncommented(line))) {
        let names = uncommented(header);
        let line = head.lines().position(|line| line == header).map_or(0, |index| index + 1);
        let columns = named(names).map_err(|what| (line, what))?;
        let columns = columns.expect("the header has been found by its names");
        let separator = table::separator(names);
        let is_comment = header.trim_start().starts_with('#');
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
    is_header(header)
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
    if layout.header_line == 0 {
        refuse_other_order(file, text, layout.separator)?;
    }
    let stamps = rows.iter().map(|row| row.stamp).collect();
    let (times_s, are_joined) = pose_stamps::times_s(layout.columns.time, stamps);
    let stated_rad = match layout.columns.orientation {
        Some(
            OrientationColumns::RollPitchYaw(_, unit_rad) | OrientationColumns::Yaw(_, unit_rad),
        ) => unit_rad,
        _ => None,
    };
    let angles: Vec<Vector3<f64>> = rows.iter().filter_map(|row| row.roll_pitch_yaw).collect();
    refuse_other_angle_unit(file, stated_rad, &angles)?;
    let angle_unit = (stated_rad.is_none() && !angles.is_empty())
        .then(|| guessed_angle_unit(angles.into_iter()));
    let unit_rad = stated_rad.or(angle_unit.map(|guess| guess.unit_rad)).unwrap_or(1.0);
    let pose = |(row, time_s): (PoseRow, f64)| {
        let angles = || Some(from_roll_pitch_yaw(&(unit_rad * row.roll_pitch_yaw?)));
        let pose = EstimatedPose {
            time_s,
            position_m: row.position_m,
            orientation: row.orientation.or_else(angles),
        };
        (pose, row.covariance)
    };
    let poses = rows.into_iter().zip(times_s).map(pose).collect();
    Ok(PoseTable {
        poses,
        rough_quaternions: rough,
        skipped,
        guessed: layout.guessed,
        are_joined,
        column_guesses: layout.columns.guesses,
        unread_columns: layout.columns.unread,
        angle_unit,
    })
}

/// Largest number of rows by which the order of columns without a header is checked.
const CHECKED_ROWS: usize = 500;

/// Refuses rows of eight columns whose numbers show another order than time, position, orientation.
fn refuse_other_order(file: &str, text: &str, separator: char) -> Result<(), OpenError> {
    let numbers = |row: &str| -> Option<[f64; 8]> {
        let fields = table::fields(row, separator).ok()?;
        let numbers: Option<Vec<f64>> =
            fields.iter().map(|field| number(field, separator != ',').ok()).collect();
        numbers?.try_into().ok()
    };
    let rows: Vec<[f64; 8]> =
        data_lines(text).filter_map(|(_, row)| numbers(row)).take(CHECKED_ROWS).collect();
    let share = |count: usize, all: usize| count as f64 / all.max(1) as f64;
    let is_unit = |first: usize| {
        let length = |row: &&[f64; 8]| {
            row[first..first + 4].iter().map(|value| value * value).sum::<f64>().sqrt()
        };
        let unit = rows.iter().filter(|row| (length(row) - 1.0).abs() < ROUNDED).count();
        !rows.is_empty() && share(unit, rows.len()) > UNIT_SHARE
    };
    let increases = |column: usize| {
        let steps = rows.windows(2).filter(|two| two[1][column] > two[0][column]).count();
        rows.len() > 2 && share(steps, rows.len() - 1) > UNIT_SHARE
    };
    let what = if is_unit(1) && !is_unit(4) {
        "columns 2 to 5 are unit quaternions, so the orientation seems to come before the position"
    } else if is_unit(3) && increases(7) && !increases(0) {
        "the last column grows like stamps, so the time seems to come last"
    } else {
        return Ok(());
    };
    Err(OpenError::file(file, what, NAME_THE_COLUMNS))
}

/// Refuses angles that are not in the unit that their names state.
fn refuse_other_angle_unit(
    file: &str,
    stated_rad: Option<f64>,
    angles: &[Vector3<f64>],
) -> Result<(), OpenError> {
    let Some(unit_rad) = stated_rad.and_then(|stated| contradicted_angle_unit(stated, angles))
    else {
        return Ok(());
    };
    let [stated, shown] =
        if unit_rad == 1.0 { ["degrees", "radians"] } else { ["radians", "degrees"] };
    let what = format!(
        "its columns state {stated}, and a full turn or a pitch in them shows that the angles are {shown}"
    );
    let remedy = format!(
        "state {shown} in the names, for example {}",
        match unit_rad {
            1.0 => "roll_rad, pitch_rad, yaw_rad",
            _ => "roll_deg, pitch_deg, yaw_deg",
        }
    );
    Err(OpenError::file(file, what, &remedy))
}

/// One row of a table.
struct PoseRow {
    stamp: Stamp,
    position_m: Vector3<f64>,
    orientation: Option<UnitQuaternion<f64>>,
    /// In the unit of the file.
    roll_pitch_yaw: Option<Vector3<f64>>,
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
            Some(names) if fields.len() == 2 * names => Err(format!(
                "{} fields where the header has {names}: numbers with decimal commas look like two, so write decimal points or \
                 semicolons between the columns",
                fields.len()
            )),
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
        let [x, y] = self.position;
        let height = self.height.map_or(Ok(0.0), value)?;
        let position = Vector3::new(value(x)?, value(y)?, height);
        let position_m = position.component_mul(&Vector3::from(self.length_m));
        if position_m.amax() > LARGEST_M {
            return Err("the position is farther away than any planet".to_owned());
        }
        let covariance = match &self.covariance {
            Some(columns) => columns.covariance(fields, separator)?,
            None => None,
        };
        let (orientation, roll_pitch_yaw, quaternion_length) = match self.orientation {
            None => (None, None, 1.0),
            Some(OrientationColumns::RollPitchYaw([roll, pitch, yaw], _)) => {
                (None, Some(Vector3::new(value(roll)?, value(pitch)?, value(yaw)?)), 1.0)
            }
            Some(OrientationColumns::Yaw(yaw, _)) => {
                (None, Some(Vector3::new(0.0, 0.0, value(yaw)?)), 1.0)
            }
            Some(OrientationColumns::Quaternion([x, y, z, w])) => {
                let raw = Quaternion::new(value(w)?, value(x)?, value(y)?, value(z)?);
                if raw.norm() < 1e-3 {
                    return Err("the quaternion is zero".to_owned());
                }
                (Some(UnitQuaternion::from_quaternion(raw)), None, raw.norm())
            }
        };
        Ok(PoseRow {
            stamp,
            position_m,
            orientation,
            roll_pitch_yaw,
            quaternion_length,
            covariance,
        })
    }
}
