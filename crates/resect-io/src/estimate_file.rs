//! Reading of trajectories of other systems: TUM, EuRoC, KITTI with times, CSV with a header, and bags of ROS 1 and ROS 2.
//!
//! The format is recognised from the lines: separator, number of fields, and names of columns. Lines that begin with `#` or `%` are
//! comments, except one that names the columns. Times above 10¹⁵ are nanoseconds.

use crate::findings::trajectories::{
    estimate_orientations_missing, estimate_out_of_order, estimate_quaternions_normalised,
    estimate_times_repeated,
};
use std::io::Read;
use std::path::{Path, PathBuf};

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

use crate::error::OpenError;
use crate::format::Format;
use crate::format::bag;
use crate::format::bag::{Piece, natural_key};
use resect_core::deployment::Finding;
use resect_core::estimates::{EstimatedPose, EstimatedTrajectory};
use resect_core::progress::Progress;

/// Largest difference of a quaternion's length from one; larger ones are errors.
const ROUNDED: f64 = 1e-2;
const FORMATS: &str = "give TUM (time x y z qx qy qz qw), EuRoC, KITTI with times.txt, CSV with the columns \
                       timestamp, x, y, z and optionally qx, qy, qz, qw, or a bag with Odometry or PoseStamped";
const CORRECT: &str = "correct or delete the line";

/// Reads a file of any supported format: one trajectory, or from a bag one for each topic of poses.
pub fn read(path: &Path) -> Result<Vec<EstimatedTrajectory>, OpenError> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let pieces = pieces_of_bag(path)?;
    if !pieces.is_empty() {
        return read_bag(path, &name, &pieces);
    }
    let text = read_text(path)?;
    let file = path.display().to_string();
    let mut findings = Vec::new();
    let poses = poses(&file, path, &text, &mut findings)?;
    if poses.is_empty() {
        return Err(OpenError::file(&file, "no pose in this file", FORMATS));
    }
    Ok(vec![put_in_order((name, None), path, poses, findings)])
}

/// Returns the files of a bag, if the path is one or a folder of one; otherwise none.
fn pieces_of_bag(path: &Path) -> Result<Vec<PathBuf>, OpenError> {
    let io = |error| OpenError::Io { path: path.to_owned(), error };
    let mut files = vec![path.to_owned()];
    if path.is_dir() {
        let entries = path.read_dir().map_err(io)?.collect::<Result<Vec<_>, _>>().map_err(io)?;
        files =
            entries.into_iter().map(|entry| entry.path()).filter(|file| file.is_file()).collect();
        files.sort_by_cached_key(|file| natural_key(&file.display().to_string()));
    }
    let mut pieces = Vec::new();
    for file in files {
        // Reading a pipe would block.
        if !file.metadata().map_err(io)?.is_file() {
            continue;
        }
        let mut head = [0; 64];
        let length =
            std::fs::File::open(&file).and_then(|mut file| file.read(&mut head)).map_err(io)?;
        let format = bag::recognise(&head[..length]);
        let is_zipped = || bag::recognise_compressed(&head[..length], &file).is_some();
        if format.is_some_and(Format::is_bag) || is_zipped() {
            pieces.push(file);
        }
    }
    Ok(pieces)
}

fn read_bag(
    path: &Path,
    name: &str,
    pieces: &[PathBuf],
) -> Result<Vec<EstimatedTrajectory>, OpenError> {
    let names: Vec<String> = pieces.iter().map(|piece| piece.display().to_string()).collect();
    let pieces: Vec<Piece<'_>> =
        pieces.iter().zip(&names).map(|(path, file)| Piece { path, file }).collect();
    let (topics, findings) = bag::poses(&pieces, &Progress::default())?;
    let file = path.display().to_string();
    if topics.is_empty() {
        let what = "no topic of type nav_msgs/Odometry or geometry_msgs/PoseStamped";
        return Err(OpenError::file(&file, what, FORMATS));
    }
    let several = topics.len() > 1;
    let estimates = topics.into_iter().map(|topic| {
        let name = if several { format!("{name} {}", topic.name) } else { name.to_owned() };
        let poses = topic.poses.iter().enumerate().map(|(index, pose)| {
            let [x, y, z, w] = pose.orientation;
            let quaternion = Quaternion::new(w, x, y, z);
            let numbers = pose.position_m.iter().chain(&pose.orientation);
            let is_sound = numbers.clone().all(|number| number.is_finite());
            // An unset rotation is all zeros.
            let orientation = if quaternion.norm() == 0.0 {
                None
            } else if (quaternion.norm() - 1.0).abs() < ROUNDED {
                Some(UnitQuaternion::from_quaternion(quaternion))
            } else {
                return Err(unsound(&file, &topic.name, index));
            };
            if !is_sound {
                return Err(unsound(&file, &topic.name, index));
            }
            let time_s = pose.stamp_s.unwrap_or_default();
            Ok(EstimatedPose { time_s, position_m: pose.position_m.into(), orientation })
        });
        let poses = poses.collect::<Result<Vec<_>, _>>()?;
        let topic = several.then(|| topic.name.clone());
        Ok(put_in_order((name, topic), path, poses, findings.clone()))
    });
    estimates.collect()
}

fn unsound(file: &str, topic: &str, index: usize) -> OpenError {
    let what =
        format!("message {} of {topic} has no finite numbers or no unit quaternion", index + 1);
    OpenError::file(file, what, "leave the topic out, or record it again")
}

/// Returns a trajectory sorted by time, without repeated times, and adds findings about the changes.
fn put_in_order(
    (name, topic): (String, Option<String>),
    path: &Path,
    mut poses: Vec<EstimatedPose>,
    mut findings: Vec<Finding>,
) -> EstimatedTrajectory {
    let file = path.display().to_string();
    if !poses.is_sorted_by(|a, b| a.time_s <= b.time_s) {
        findings.push(estimate_out_of_order(&file));
        poses.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    }
    let all = poses.len();
    poses.dedup_by_key(|pose| pose.time_s);
    if poses.len() < all {
        findings.push(estimate_times_repeated(&file, all - poses.len()));
    }
    let with = poses.iter().filter(|pose| pose.orientation.is_some()).count();
    if with > 0 && with < poses.len() {
        let without = poses.len() - with;
        findings.push(estimate_orientations_missing(&file, without, poses.len()));
        poses.iter_mut().for_each(|pose| pose.orientation = None);
    }
    EstimatedTrajectory { name, path: path.to_owned(), topic, poses, findings }
}

fn read_text(path: &Path) -> Result<String, OpenError> {
    let io = |error| OpenError::Io { path: path.to_owned(), error };
    // Reading a pipe would block.
    if !path.metadata().map_err(io)?.is_file() {
        return Err(OpenError::file(&path.display().to_string(), "not a regular file", FORMATS));
    }
    let bytes = std::fs::read(path).map_err(io)?;
    String::from_utf8(bytes)
        .map_err(|_| OpenError::file(&path.display().to_string(), "not a text file", FORMATS))
}

/// Indices of the columns.
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
/// Numbers in a line of KITTI: the first three rows of a 4×4 matrix.
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
                    format!("the header `{line}` has no columns of poses"),
                    FORMATS,
                )
            })?);
            continue;
        }
        if (first || !rows_of_kitti.is_empty()) && fields.len() == KITTI && !line.contains(',') {
            let row = values.and_then(|values| values.try_into().ok());
            let row: [f64; KITTI] = row
                .filter(|row: &[f64; KITTI]| row.iter().all(|v| v.is_finite()))
                .ok_or_else(|| OpenError::line(file, number, "a field is not a number", CORRECT))?;
            rows_of_kitti.push(row);
            continue;
        }
        if columns.is_none() {
            columns = without_names(line, &fields);
        }
        let columns = columns.ok_or_else(|| {
            let what = format!("{} fields do not form a pose", fields.len());
            OpenError::line(file, number, what, FORMATS)
        })?;
        let (pose, length) =
            pose(&fields, &columns).map_err(|what| OpenError::line(file, number, what, CORRECT))?;
        rough += usize::from((length - 1.0).abs() > ROUNDED);
        poses.push(pose);
    }
    if rough > 0 {
        findings.push(estimate_quaternions_normalised(file, rough));
    }
    if rows_of_kitti.is_empty() { Ok(poses) } else { of_kitti(file, path, &rows_of_kitti) }
}

fn split(line: &str) -> Box<dyn Iterator<Item = &str> + '_> {
    match [',', ';'].into_iter().find(|separator| line.contains(*separator)) {
        Some(separator) => Box::new(line.split(separator).map(str::trim)),
        None => Box::new(line.split_whitespace()),
    }
}

/// Returns the columns by the names in a header; `None` without time or position.
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

/// Returns a column's name in lower case without its unit: `p_RS_R_x [m]` becomes `p_rs_r_x`, `x_m` becomes `x`.
fn plain(name: &str) -> String {
    let name = name.split(['[', '(']).next().unwrap_or_default().trim().to_lowercase();
    let name = name.replace(['.', '/', ' '], "_");
    name.strip_suffix("_m").unwrap_or(&name).trim_matches('"').to_owned()
}

/// Returns the columns of a line of numbers, by the number of fields and the separator.
fn without_names(line: &str, fields: &[&str]) -> Option<Columns> {
    let is_euroc = line.contains(',') && fields[0].parse::<f64>().is_ok_and(|t| t.abs() > 1e15);
    match fields.len() {
        8.. if is_euroc => Some(EUROC),
        8 => Some(TUM),
        4 => Some(POSITIONS),
        _ => None,
    }
}

/// Returns the pose of a line, and the length of its quaternion before normalisation.
fn pose(fields: &[&str], columns: &Columns) -> Result<(EstimatedPose, f64), String> {
    let value = |column: usize| -> Result<f64, String> {
        let field = fields.get(column).ok_or_else(|| format!("only {} fields", fields.len()))?;
        match field.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(format!("`{field}` is not a number")),
        }
    };
    let [x, y, z] = columns.position;
    let position_m = Vector3::new(value(x)?, value(y)?, value(z)?);
    let (orientation, length) = match columns.orientation {
        None => (None, 1.0),
        Some([x, y, z, w]) => {
            let raw = Quaternion::new(value(w)?, value(x)?, value(y)?, value(z)?);
            let length = raw.norm();
            if length < 1e-3 {
                return Err("the quaternion is zero".to_owned());
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

/// Returns seconds. Nanoseconds are split as integers, since they have more digits than a double.
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

/// Poses of KITTI, whose times are in a separate file in the same folder.
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
                    format!("`{line}` is not a time"),
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
            // Rows rounded to a few digits are not exactly a rotation.
            orientation: Some(UnitQuaternion::from(Rotation3::from_matrix(&matrix))),
        }
    };
    Ok(times_s.into_iter().zip(rows).map(pose).collect())
}

#[cfg(test)]
#[path = "estimate_file_tests.rs"]
mod tests;
