//! Reading of trajectories of other systems: TUM, EuRoC, KITTI with times, CSV with a header, positions of GNSS receivers, motion capture, and
//! bags of ROS 1 and ROS 2.
//!
//! [`pose_table`] reads the tables, [`local_positions`](crate::local_positions) converts latitude and longitude.

use crate::findings::trajectories::{
    estimate_angle_unit_guessed, estimate_angles_not_read, estimate_columns_guessed,
    estimate_columns_named, estimate_columns_unread, estimate_covariances_missing,
    estimate_orientations_constant, estimate_orientations_missing, estimate_out_of_order,
    estimate_poses_skipped, estimate_positions_rounded, estimate_quaternions_normalised,
    estimate_stamps_joined, estimate_times_by_number, estimate_times_repeated,
};
use std::io::Read;
use std::path::{Path, PathBuf};

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::error::OpenError;
use crate::findings::tracks::rows_skipped;
use crate::format::Format;
use crate::format::bag;
use crate::format::bag::{Piece, PoseTopic, RecordedPoses, natural_key};
use crate::format::estimate::is_kitti;
use crate::format::kitti;
use crate::format::motion_capture::{self, CapturedBody};
use crate::format::pose_covariance::{file_beside, of_message, read_beside};
use crate::format::pose_table::{self, FORMATS, LARGEST_M};
use crate::format::text_encoding::decode_text;
use crate::format::{geodetic_table, nav_sat_fix, nmea, rtklib_pos};
use crate::gnss_solution::{GnssTrack, SolutionChoice};
use crate::local_positions::local_positions;
use crate::rounding::rounded_axis;
use crate::skipped_rows::SkippedRows;
use resect_core::deployment::Finding;
use resect_core::progress::Progress;
use resect_tools::estimates::{EstimatedPose, EstimatedTrajectory, PoseCovariance};

/// Largest difference of a quaternion's length from one; larger ones are errors.
const ROUNDED: f64 = 1e-2;

/// A pose with its covariance, if the file states it.
type StatedPose = (EstimatedPose, Option<PoseCovariance>);

/// Number of topics that an error lists.
const LISTED_TOPICS: usize = 8;
/// Most different poses per time: two, of a path that is written twice.
const MOST_AT_A_TIME: usize = 2;

/// Topics of a bag that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum WantedTopics {
    /// Poses; without any, positions.
    PosesElsePoints,
    PosesAndPoints,
}

/// Trajectories of a file that are read.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    topics: WantedTopics,
    /// Solutions of a GNSS receiver that are a ground truth; `None` for all of an estimate, which is evaluated with its errors.
    solutions: Option<SolutionChoice>,
}

/// Reads a file of any supported format: one trajectory, or from a bag one for each topic of poses.
pub fn read(path: &Path) -> Result<Vec<EstimatedTrajectory>, OpenError> {
    read_wanted(path, Wanted { topics: WantedTopics::PosesElsePoints, solutions: None })
}

/// Times of KITTI poses without a file of times: their numbers at a rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumberedTimes {
    pub rate_hz: f64,
    /// True if the user gave the rate; otherwise poses are compared by their numbers.
    pub is_given: bool,
}

/// Returns the number of poses of a KITTI file without times; `None` for other files.
pub fn poses_without_times(path: &Path) -> Option<usize> {
    if !path.is_file() || kitti::times_beside(path).is_some() {
        return None;
    }
    let text = read_text(path).ok().filter(|text| is_kitti(text))?;
    Some(kitti::rows(&path.display().to_string(), &text).ok()?.len())
}

/// Reads a KITTI file without times, with a finding about its times.
pub fn read_frames(path: &Path, times: NumberedTimes) -> Result<EstimatedTrajectory, OpenError> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let file = path.display().to_string();
    let rows = kitti::rows(&file, &read_text(path)?)?;
    let pose = |(number, row): (usize, &_)| kitti::pose(number as f64 / times.rate_hz, row);
    let poses = rows.iter().enumerate().map(pose).map(|pose| (pose, None)).collect();
    let poses = with_covariances_beside(path, poses)?;
    let finding = estimate_times_by_number(&file, rows.len(), times.rate_hz, times.is_given);
    put_in_order((name, None), path, poses, vec![finding])
}

/// Reads the one trajectory of a file that is the ground truth; `topic` chooses among those of a bag, `solutions` among those of a
/// GNSS receiver.
pub fn read_truth(
    path: &Path,
    topic: Option<&str>,
    solutions: SolutionChoice,
) -> Result<EstimatedTrajectory, OpenError> {
    let topics = match topic {
        Some(_) => WantedTopics::PosesAndPoints,
        None => WantedTopics::PosesElsePoints,
    };
    let mut all = read_wanted(path, Wanted { topics, solutions: Some(solutions) })?;
    let topics: Vec<String> = all.iter().filter_map(|one| one.topic.clone()).collect();
    if let Some(topic) = topic.filter(|_| topics.is_empty())
        && !is_bag(path)?
    {
        let remedy = format!("leave out {topic}");
        return Err(OpenError::file(&path.display().to_string(), "it has no topics", remedy));
    }
    // A single topic needs no choice, whatever its name.
    if let Some(topic) = topic.filter(|_| !topics.is_empty()) {
        all.retain(|one| one.topic.as_deref() == Some(topic));
    }
    match (all.pop(), all.is_empty()) {
        (Some(only), true) => Ok(only),
        _ => {
            let what = match topic {
                Some(topic) => format!("no poses or points in {topic}"),
                None => format!("{} topics with poses", topics.len()),
            };
            let remedy = format!(
                "name one (--truth-topic, or --topic of extrinsics): {}",
                topics.join(", ")
            );
            Err(OpenError::file(&path.display().to_string(), what, remedy))
        }
    }
}

/// Returns true for a bag, or a part of one.
pub fn is_bag(path: &Path) -> Result<bool, OpenError> {
    Ok(!pieces_of_bag(path)?.is_empty())
}

fn read_wanted(path: &Path, wanted: Wanted) -> Result<Vec<EstimatedTrajectory>, OpenError> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let pieces = pieces_of_bag(path)?;
    if !pieces.is_empty() {
        return read_bag(path, &name, &pieces, wanted);
    }
    let text = read_text(path)?;
    let file = path.display().to_string();
    if motion_capture::looks_like(&text) {
        return read_motion_capture(path, &name, &text);
    }
    let (mut findings, mut origin) = (Vec::new(), None);
    let poses = match gnss_track(&file, &text)? {
        Some(track) => {
            let local = local_positions(&file, track, wanted.solutions, None)?;
            findings.extend(local.findings);
            origin = local.origin;
            local.poses
        }
        None => poses(&file, path, &text, &mut findings)?,
    };
    if poses.is_empty() {
        return Err(OpenError::file(&file, "no pose in this file", FORMATS));
    }
    let trajectory = put_in_order((name, None), path, poses, findings)?;
    Ok(vec![EstimatedTrajectory { origin, ..trajectory }])
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

/// Reads the bodies of a motion capture, each with its name as the topic if there are several.
fn read_motion_capture(
    path: &Path,
    name: &str,
    text: &str,
) -> Result<Vec<EstimatedTrajectory>, OpenError> {
    let file = path.display().to_string();
    let bodies = motion_capture::read(&file, text)?;
    let several = bodies.len() > 1;
    let trajectory = |body: CapturedBody| {
        let CapturedBody { name: body, poses, skipped, has_angles } = body;
        let mut findings: Vec<Finding> = rows_skipped(&file, &skipped).into_iter().collect();
        if has_angles {
            findings.push(estimate_angles_not_read(&file, &body));
        }
        let poses = poses.into_iter().map(|pose| (pose, None)).collect();
        let (name, topic) = match several {
            true => (format!("{name} {body}"), Some(body)),
            false => (name.to_owned(), None),
        };
        put_in_order((name, topic), path, poses, findings)
    };
    bodies.into_iter().map(trajectory).collect()
}

fn read_bag(
    path: &Path,
    name: &str,
    pieces: &[PathBuf],
    wanted: Wanted,
) -> Result<Vec<EstimatedTrajectory>, OpenError> {
    let names: Vec<String> = pieces.iter().map(|piece| piece.display().to_string()).collect();
    let pieces: Vec<Piece<'_>> =
        pieces.iter().zip(&names).map(|(path, file)| Piece { path, file }).collect();
    let RecordedPoses { mut topics, all_topics, findings } =
        bag::poses(&pieces, &Progress::default())?;
    let has_poses = topics.iter().any(|topic| !topic.are_points);
    if wanted.topics == WantedTopics::PosesElsePoints && has_poses {
        topics.retain(|topic| !topic.are_points);
    }
    let file = path.display().to_string();
    if topics.is_empty() {
        let topics = match all_topics.len() {
            0 => "none".to_owned(),
            _ => all_topics.iter().take(LISTED_TOPICS).cloned().collect::<Vec<_>>().join(", "),
        };
        let what = format!(
            "no poses in Odometry, PoseStamped, TransformStamped, PointStamped, NavSatFix or /tf; its topics: {topics}"
        );
        let remedy =
            "record the poses of the body as Odometry or PoseStamped, or export them as a table";
        return Err(OpenError::file(&file, what, remedy));
    }
    let several = topics.len() > 1;
    let estimates = topics.into_iter().map(|messages| {
        let name = if several { format!("{name} {}", messages.name) } else { name.to_owned() };
        let (mut findings, mut origin) = (findings.clone(), None);
        let poses = if messages.fixes.is_empty() {
            poses_of_topic(&file, &messages, &mut findings)?
        } else {
            let track = nav_sat_fix::track(&file, &messages.fixes);
            let local = local_positions(&file, track, wanted.solutions, None)?;
            findings.extend(local.findings);
            origin = local.origin;
            local.poses
        };
        let topic = several.then(|| messages.name.clone());
        let frames = messages.poses.first().and_then(|pose| pose.frames.clone());
        let trajectory = put_in_order((name, topic), path, poses, findings)?;
        Ok(EstimatedTrajectory { frames, origin, ..trajectory })
    });
    estimates.collect()
}

/// Returns the poses of the messages of a topic, and adds a finding about those that are skipped.
fn poses_of_topic(
    file: &str,
    topic: &PoseTopic,
    findings: &mut Vec<Finding>,
) -> Result<Vec<StatedPose>, OpenError> {
    let (mut poses, mut skipped) = (Vec::new(), SkippedRows::default());
    for (index, pose) in topic.poses.iter().enumerate() {
        let covariance = pose.covariance.as_ref().and_then(|elements| of_message(&elements[..]));
        match pose_of_message(pose) {
            Ok(pose) => poses.push((pose, covariance)),
            Err(reason) => skipped.add(index + 1, reason),
        }
    }
    if let Some((message, reason)) = skipped.first.as_ref().filter(|_| skipped.count > poses.len())
    {
        let what = format!("message {message} of {} {reason}", topic.name);
        return Err(OpenError::file(file, what, "leave the topic out, or record it again"));
    }
    findings.extend(estimate_poses_skipped(file, &topic.name, &skipped));
    Ok(poses)
}

/// Returns the pose of a message, or the reason why it is not one. An unset rotation is all zeros.
fn pose_of_message(pose: &bag::messages::StampedPose) -> Result<EstimatedPose, String> {
    let [x, y, z, w] = pose.orientation;
    let quaternion = Quaternion::new(w, x, y, z);
    if !pose.position_m.iter().chain(&pose.orientation).all(|number| number.is_finite()) {
        return Err("has no finite numbers".to_owned());
    }
    if pose.position_m.iter().any(|coordinate| coordinate.abs() > LARGEST_M) {
        return Err("has a position farther away than any planet".to_owned());
    }
    let orientation = if quaternion.norm() == 0.0 {
        None
    } else if (quaternion.norm() - 1.0).abs() < ROUNDED {
        Some(UnitQuaternion::from_quaternion(quaternion))
    } else {
        return Err("has no unit quaternion".to_owned());
    };
    let time_s = pose.stamp_s.unwrap_or_default();
    Ok(EstimatedPose { time_s, position_m: pose.position_m.into(), orientation })
}

/// Returns a trajectory sorted by time, without repeated times, and adds findings about the changes; an error if most poses share a time.
pub fn put_in_order(
    (name, topic): (String, Option<String>),
    path: &Path,
    mut poses: Vec<StatedPose>,
    mut findings: Vec<Finding>,
) -> Result<EstimatedTrajectory, OpenError> {
    let file = path.display().to_string();
    if !poses.is_sorted_by(|a, b| a.0.time_s <= b.0.time_s) {
        findings.push(estimate_out_of_order(&file));
        poses.sort_by(|a, b| a.0.time_s.total_cmp(&b.0.time_s));
    }
    let all = poses.len();
    poses.dedup_by(|a, b| a.0 == b.0);
    let different = poses.len();
    poses.dedup_by_key(|(pose, _)| pose.time_s);
    if different > MOST_AT_A_TIME * poses.len() {
        let what = format!(
            "{different} poses have only {} different times: the stamps are rounded or missing",
            poses.len()
        );
        return Err(OpenError::file(&file, what, "write the stamps with more digits"));
    }
    if let (Some((first, _)), Some((last, _))) = (poses.first(), poses.last())
        && poses.len() >= FEWEST_UNSET
        && last.time_s - first.time_s < SHORTEST_SPAN_S
    {
        let what = format!("no pose has a time: all {} lie within a millisecond", poses.len());
        return Err(OpenError::file(&file, what, "record the stamps of the poses"));
    }
    if poses.len() < all {
        findings.push(estimate_times_repeated(&file, all - poses.len()));
    }
    let (mut poses, stated): (Vec<EstimatedPose>, Vec<Option<PoseCovariance>>) =
        poses.into_iter().unzip();
    let with = poses.iter().filter(|pose| pose.orientation.is_some()).count();
    if with > 0 && with < poses.len() {
        let without = poses.len() - with;
        findings.push(estimate_orientations_missing(&file, without, poses.len()));
        poses.iter_mut().for_each(|pose| pose.orientation = None);
    }
    let positions_m: Vec<Vector3<f64>> = poses.iter().map(|pose| pose.position_m).collect();
    findings
        .extend(rounded_axis(&positions_m).map(|(axis, step_m)| {
            estimate_positions_rounded(&file, ["x", "y", "z"][axis], step_m)
        }));
    if are_orientations_unset(&poses) {
        findings.push(estimate_orientations_constant(&file));
        poses.iter_mut().for_each(|pose| pose.orientation = None);
    }
    let covariances: Vec<PoseCovariance> = stated.iter().flatten().copied().collect();
    let complete = covariances.len() == poses.len();
    if !complete && !covariances.is_empty() {
        let without = poses.len() - covariances.len();
        findings.push(estimate_covariances_missing(&file, without, poses.len()));
    }
    let covariances = if complete { covariances } else { Vec::new() };
    let path = path.to_owned();
    Ok(EstimatedTrajectory {
        name,
        path,
        topic,
        frames: None,
        poses,
        covariances,
        origin: None,
        findings,
    })
}

/// Shortest span of a trajectory (s).
const SHORTEST_SPAN_S: f64 = 1e-3;
/// Fewest poses and shortest extent of positions (m) that reveal an unset orientation.
const FEWEST_UNSET: usize = 5;
const LEAST_EXTENT_M: f64 = 0.1;

/// Returns true if all orientations are equal although the positions move: files of positions have 0 0 0 1 in their columns.
fn are_orientations_unset(poses: &[EstimatedPose]) -> bool {
    let Some(first) = poses.first().filter(|_| poses.len() >= FEWEST_UNSET) else { return false };
    let moves = |pose: &EstimatedPose| (pose.position_m - first.position_m).norm() > LEAST_EXTENT_M;
    first.orientation.is_some()
        && poses.iter().all(|pose| pose.orientation == first.orientation)
        && poses.iter().any(moves)
}

fn read_text(path: &Path) -> Result<String, OpenError> {
    let io = |error| OpenError::Io { path: path.to_owned(), error };
    // Reading a pipe would block.
    if !path.metadata().map_err(io)?.is_file() {
        return Err(OpenError::file(&path.display().to_string(), "not a regular file", FORMATS));
    }
    let bytes = std::fs::read(path).map_err(io)?;
    decode_text(&bytes)
        .ok_or_else(|| OpenError::file(&path.display().to_string(), "not a text file", FORMATS))
}

/// Reads the solutions of a GNSS receiver in a text file.
///
/// # Errors
/// If the file has another content.
pub fn gnss_track_of_file(path: &Path) -> Result<GnssTrack, OpenError> {
    let file = path.display().to_string();
    gnss_track(&file, &read_text(path)?)?.ok_or_else(|| {
        let remedy = "give RTKLIB (.pos), NMEA, or a table with latitude, longitude and height";
        OpenError::file(&file, "not a GNSS solution", remedy)
    })
}

/// Returns the positions of a GNSS receiver, if a text has the format of any.
fn gnss_track(file: &str, text: &str) -> Result<Option<GnssTrack>, OpenError> {
    Ok(if rtklib_pos::looks_like(text) {
        Some(rtklib_pos::read_track(file, text)?)
    } else if nmea::looks_like(text) {
        Some(nmea::read(file, text)?)
    } else if geodetic_table::looks_like(text) {
        Some(geodetic_table::read(file, text)?)
    } else {
        None
    })
}

/// Reads the poses of a text, and adds findings about skipped rows and guesses.
fn poses(
    file: &str,
    path: &Path,
    text: &str,
    findings: &mut Vec<Finding>,
) -> Result<Vec<StatedPose>, OpenError> {
    if is_kitti(text) {
        let rows = kitti::rows(file, text)?;
        let times_file = kitti::times_beside(path).ok_or_else(|| kitti::no_times(file, path))?;
        let name = times_file.display().to_string();
        let times_s = kitti::times_s(&name, &read_text(&times_file)?)?;
        if times_s.len() != rows.len() {
            let what = format!("{} times for {} poses of {file}", times_s.len(), rows.len());
            return Err(OpenError::file(&name, what, "each pose needs one"));
        }
        let poses: Vec<EstimatedPose> =
            times_s.into_iter().zip(&rows).map(|(time_s, row)| kitti::pose(time_s, row)).collect();
        return with_covariances_beside(path, poses.into_iter().map(|pose| (pose, None)).collect());
    }
    let table = pose_table::read(file, text)?;
    findings.extend(rows_skipped(file, &table.skipped));
    findings.extend(table.guessed.map(|layout| estimate_columns_guessed(file, layout)));
    if table.are_joined {
        findings.push(estimate_stamps_joined(file));
    }
    let named = |guess: &&str| estimate_columns_named(file, guess);
    findings.extend(table.column_guesses.iter().map(named));
    findings.extend(
        table.angle_unit.map(|unit| estimate_angle_unit_guessed(file, unit.unit_rad, unit.largest)),
    );
    if !table.unread_columns.is_empty() {
        findings.push(estimate_columns_unread(file, &table.unread_columns));
    }
    if table.rough_quaternions > 0 {
        findings.push(estimate_quaternions_normalised(file, table.rough_quaternions));
    }
    with_covariances_beside(path, table.poses)
}

/// Adds the covariances of a file beside the table, if there is one.
fn with_covariances_beside(
    path: &Path,
    poses: Vec<StatedPose>,
) -> Result<Vec<StatedPose>, OpenError> {
    let Some(beside) = file_beside(path) else { return Ok(poses) };
    let text = read_text(&beside)?;
    let poses: Vec<EstimatedPose> = poses.into_iter().map(|(pose, _)| pose).collect();
    let covariances = read_beside(&beside.display().to_string(), &text, &poses)?;
    Ok(poses.into_iter().zip(covariances).collect())
}

#[cfg(test)]
#[path = "estimate_file_tests.rs"]
mod tests;
