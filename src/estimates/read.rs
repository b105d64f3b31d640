//! Trajectories of other systems, read from their files: TUM, EuRoC, KITTI with its times, and CSV with a header.
//!
//! What a file is, is told from its lines: commas or spaces, how many numbers, and the names of the columns. Lines that begin
//! with `#` or `%` are comments, but for one that names columns. Times above 10¹⁵ are nanoseconds.

use std::path::Path;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::{Estimate, EstimatedPose};
use crate::deployment::{Finding, OpenError};

/// Quaternions whose length differs from one by more are wrong, and are said to be.
const ROUNDED: f64 = 1e-2;
const FORMATS: &str = "give TUM (time x y z qx qy qz qw), EuRoC, KITTI with times.txt, or CSV whose header names \
                       timestamp, x, y, z and perhaps qx, qy, qz, qw";
const CORRECT: &str = "correct or delete the line";

/// Reads an estimate, whatever its format is.
pub fn read(path: &Path) -> Result<Estimate, OpenError> {
    let text = read_text(path)?;
    let file = path.display().to_string();
    let mut findings = Vec::new();
    let mut poses = poses(&file, path, &text, &mut findings)?;
    if poses.is_empty() {
        return Err(OpenError::file(&file, "there is no pose in it", FORMATS));
    }
    if !poses.is_sorted_by(|a, b| a.time_s <= b.time_s) {
        findings.push(Finding::warning(format!("{file}: its times go back; sorted")));
        poses.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    }
    let all = poses.len();
    poses.dedup_by_key(|pose| pose.time_s);
    if poses.len() < all {
        let line =
            format!("{file}: {} poses repeat a time; the first of each is kept", all - poses.len());
        findings.push(Finding::warning(line));
    }
    let with = poses.iter().filter(|pose| pose.orientation.is_some()).count();
    if with > 0 && with < poses.len() {
        let line = format!(
            "{file}: {} of {} poses have no orientation; none is used",
            poses.len() - with,
            poses.len()
        );
        findings.push(Finding::warning(line));
        poses.iter_mut().for_each(|pose| pose.orientation = None);
    }
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Estimate { name, path: path.to_owned(), poses, findings })
}

fn read_text(path: &Path) -> Result<String, OpenError> {
    let io = |error| OpenError::Io { path: path.to_owned(), error };
    // To read a pipe would wait for whoever writes to it.
    if !path.metadata().map_err(io)?.is_file() {
        return Err(OpenError::file(&path.display().to_string(), "no file", FORMATS));
    }
    let bytes = std::fs::read(path).map_err(io)?;
    String::from_utf8(bytes)
        .map_err(|_| OpenError::file(&path.display().to_string(), "it is no text", FORMATS))
}

/// Which column holds what.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Columns {
    time: usize,
    position: [usize; 3],
    /// x, y, z, w.
    orientation: Option<[usize; 4]>,
}

const TUM: Columns = Columns { time: 0, position: [1, 2, 3], orientation: Some([4, 5, 6, 7]) };
const POSITIONS: Columns = Columns { orientation: None, ..TUM };
const EUROC: Columns = Columns { orientation: Some([5, 6, 7, 4]), ..TUM };
/// Numbers in a line of KITTI: the first three rows of a matrix.
const KITTI: usize = 12;

fn poses(
    file: &str,
    path: &Path,
    text: &str,
    findings: &mut Vec<Finding>,
) -> Result<Vec<EstimatedPose>, OpenError> {
    let mut columns: Option<Columns> = None;
    let mut poses = Vec::new();
    let mut rows_of_kitti: Vec<[f64; KITTI]> = Vec::new();
    let mut rough = 0;
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let (number, line) = (index + 1, line.trim());
        if line.is_empty() {
            continue;
        }
        if let Some(comment) = line.strip_prefix(['#', '%']) {
            if columns.is_none() && comment.contains(',') {
                columns = named(comment);
            }
            continue;
        }
        let fields: Vec<&str> = split(line).collect();
        let values: Option<Vec<f64>> = fields.iter().map(|field| field.parse().ok()).collect();
        let first = columns.is_none() && rows_of_kitti.is_empty();
        if first && fields[0].parse::<f64>().is_err() {
            columns = Some(named(line).ok_or_else(|| {
                OpenError::line(
                    file,
                    number,
                    format!("the header `{line}` names no poses"),
                    FORMATS,
                )
            })?);
            continue;
        }
        if (first || !rows_of_kitti.is_empty()) && fields.len() == KITTI && !line.contains(',') {
            let row = values.and_then(|values| values.try_into().ok());
            let row: [f64; KITTI] = row
                .filter(|row: &[f64; KITTI]| row.iter().all(|v| v.is_finite()))
                .ok_or_else(|| OpenError::line(file, number, "a field is no number", CORRECT))?;
            rows_of_kitti.push(row);
            continue;
        }
        if columns.is_none() {
            columns = without_names(line, &fields);
        }
        let columns = columns.ok_or_else(|| {
            let what = format!("{} fields are no pose", fields.len());
            OpenError::line(file, number, what, FORMATS)
        })?;
        let (pose, length) =
            pose(&fields, &columns).map_err(|what| OpenError::line(file, number, what, CORRECT))?;
        rough += usize::from((length - 1.0).abs() > ROUNDED);
        poses.push(pose);
    }
    if rough > 0 {
        let line = format!("{file}: {rough} quaternions have another length than one; made one");
        findings.push(Finding::warning(line));
    }
    if rows_of_kitti.is_empty() { Ok(poses) } else { of_kitti(file, path, &rows_of_kitti) }
}

fn split(line: &str) -> Box<dyn Iterator<Item = &str> + '_> {
    match [',', ';'].into_iter().find(|separator| line.contains(*separator)) {
        Some(separator) => Box::new(line.split(separator).map(str::trim)),
        None => Box::new(line.split_whitespace()),
    }
}

/// The columns by the names of a header; `None` if time or position are not among them.
fn named(header: &str) -> Option<Columns> {
    let names: Vec<String> = split(header).map(plain).collect();
    let at = |candidates: &[String]| names.iter().position(|name| candidates.contains(name));
    let axis = |prefixes: &[&str], axis: &str| {
        at(&prefixes.iter().map(|prefix| format!("{prefix}{axis}")).collect::<Vec<_>>())
    };
    const POSITION: [&str; 9] = [
        "",
        "t",
        "p",
        "p_",
        "pos_",
        "position_",
        "p_rs_r_",
        "pose_position_",
        "pose_pose_position_",
    ];
    const ORIENTATION: [&str; 8] = [
        "q",
        "q_",
        "q_rs_",
        "quat_",
        "orientation_",
        "rotation_",
        "pose_orientation_",
        "pose_pose_orientation_",
    ];
    let times = ["timestamp", "time", "t", "timestamp_s", "time_s", "stamp"].map(str::to_owned);
    let orientation = ["x", "y", "z", "w"].map(|name| axis(&ORIENTATION, name));
    let [Some(x), Some(y), Some(z)] = ["x", "y", "z"].map(|name| axis(&POSITION, name)) else {
        return None;
    };
    Some(Columns {
        time: at(&times)?,
        position: [x, y, z],
        orientation: match orientation {
            [Some(x), Some(y), Some(z), Some(w)] => Some([x, y, z, w]),
            _ => None,
        },
    })
}

/// A column's name without its unit, in small letters: `p_RS_R_x [m]` is `p_rs_r_x`, `x_m` is `x`.
fn plain(name: &str) -> String {
    let name = name.split(['[', '(']).next().unwrap_or_default().trim().to_lowercase();
    let name = name.replace(['.', '/', ' '], "_");
    name.strip_suffix("_m").unwrap_or(&name).trim_matches('"').to_owned()
}

/// The columns of a line of numbers by how many there are and what parts them.
fn without_names(line: &str, fields: &[&str]) -> Option<Columns> {
    let is_euroc = line.contains(',') && fields[0].parse::<f64>().is_ok_and(|t| t.abs() > 1e15);
    match fields.len() {
        8.. if is_euroc => Some(EUROC),
        8 => Some(TUM),
        4 => Some(POSITIONS),
        _ => None,
    }
}

/// The pose of a line, and the length that its quaternion had.
fn pose(fields: &[&str], columns: &Columns) -> Result<(EstimatedPose, f64), String> {
    let value = |column: usize| -> Result<f64, String> {
        let field =
            fields.get(column).ok_or_else(|| format!("it has only {} fields", fields.len()))?;
        match field.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(format!("`{field}` is no number")),
        }
    };
    let [x, y, z] = columns.position;
    let position_m = Vector3::new(value(x)?, value(y)?, value(z)?);
    let (orientation, length) = match columns.orientation {
        None => (None, 1.0),
        Some([x, y, z, w]) => {
            let raw = nalgebra::Quaternion::new(value(w)?, value(x)?, value(y)?, value(z)?);
            let length = raw.norm();
            if length < 1e-3 {
                return Err("its quaternion is zero".to_owned());
            }
            (Some(UnitQuaternion::from_quaternion(raw)), length)
        }
    };
    Ok((
        EstimatedPose {
            time_s: seconds(fields[columns.time], value(columns.time)?),
            position_m,
            orientation,
        },
        length,
    ))
}

/// Seconds, which nanoseconds are too many digits for to be read as one number and divided.
fn seconds(field: &str, value: f64) -> f64 {
    if value.abs() <= 1e15 {
        return value;
    }
    match field.parse::<i128>() {
        Ok(nanoseconds) => {
            (nanoseconds / 1_000_000_000) as f64 + 1e-9 * (nanoseconds % 1_000_000_000) as f64
        }
        Err(_) => 1e-9 * value,
    }
}

/// Poses of KITTI, whose times lie in a file beside them.
fn of_kitti(
    file: &str,
    path: &Path,
    rows: &[[f64; KITTI]],
) -> Result<Vec<EstimatedPose>, OpenError> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let beside = [format!("{stem}_times.txt"), "times.txt".to_owned()];
    let found = beside.iter().map(|name| path.with_file_name(name)).find(|path| path.is_file());
    let times_file = found.ok_or_else(|| {
        OpenError::file(
            file,
            "KITTI poses have no times",
            format!("put {} beside it", beside.join(" or ")),
        )
    })?;
    let name = times_file.display().to_string();
    let mut times_s = Vec::new();
    for (index, line) in read_text(&times_file)?.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        match line.parse::<f64>() {
            Ok(time) if time.is_finite() => times_s.push(seconds(line, time)),
            _ => {
                return Err(OpenError::line(
                    &name,
                    index + 1,
                    format!("`{line}` is no time"),
                    CORRECT,
                ));
            }
        }
    }
    if times_s.len() != rows.len() {
        let what = format!("{} times for {} poses of {file}", times_s.len(), rows.len());
        return Err(OpenError::file(&name, what, "each pose needs one"));
    }
    let pose = |(time_s, row): (f64, &[f64; KITTI])| {
        let matrix = Matrix3::from_fn(|r, c| row[4 * r + c]);
        EstimatedPose {
            time_s,
            position_m: Vector3::new(row[3], row[7], row[11]),
            // Rounded to a few digits, rows are no rotation any more.
            orientation: Some(UnitQuaternion::from(Rotation3::from_matrix(&matrix))),
        }
    };
    Ok(times_s.into_iter().zip(rows).map(pose).collect())
}

#[cfg(test)]
#[path = "read_tests.rs"]
mod tests;
