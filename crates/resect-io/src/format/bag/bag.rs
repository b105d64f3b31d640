//! Reading of a recording: its container is recognised by the first bytes, its files are read one after the other.

use resect_core::network::PerStation;
use std::fs::File;
use std::path::Path;

use super::container::Positioned;
use super::inflate::Budget;
use super::intake::{Intake, natural_key};
use super::messages::{Kind, NavSatFix, StampedPose};
use super::{inflate, mcap, ros1, sqlite};
use crate::error::OpenError;
use crate::format::format::Format;
use crate::recording::Recording;
use resect_core::deployment::Finding;
use resect_core::progress::Progress;

/// One file of a recording: its path, and its name in findings.
#[derive(Clone, Copy, Debug)]
pub struct Piece<'a> {
    pub path: &'a Path,
    pub file: &'a str,
}

/// Bytes from a file's beginning that suffice to recognise it.
const HEAD_BYTES: u64 = 4096;

/// Recognises a file of a bag by its first bytes (up to [`HEAD_BYTES`]); `None` for other files.
pub fn recognise(head: &[u8]) -> Option<Format> {
    Some(if head.starts_with(b"#ROSBAG") {
        Format::Ros1Bag
    } else if head.starts_with(mcap::MAGIC) {
        Format::Mcap
    } else if head.starts_with(sqlite::MAGIC) {
        if sqlite::may_be_a_bag(head) {
            Format::Ros2Sqlite
        } else {
            Format::Ignored("an SQLite database, not a ROS 2 bag")
        }
    } else if sqlite::is_log(head) {
        Format::Ignored("left by an interrupted recording; read with the bag beside it")
    } else if head.starts_with(&inflate::ZSTD_MAGIC) {
        Format::Ignored("compressed with zstd, not a ROS 2 bag")
    } else if head.starts_with(b"rosbag2_bagfile_information:") {
        Format::RosbagMetadata
    } else {
        return None;
    })
}

/// Recognises a bag that is compressed as a whole; `None` if it is not compressed, or not a bag.
pub fn recognise_compressed(head: &[u8], path: &Path) -> Option<Format> {
    if !head.starts_with(&inflate::ZSTD_MAGIC) {
        return None;
    }
    let inner = inflate::head(File::open(path).ok()?, HEAD_BYTES);
    recognise(&inner).filter(|format| format.is_bag())
}

/// Reads all readings of one recording, its files one after the other.
///
/// `topics` are those of stations 1, 2, …, for positions that do not name their station. If they are needed and missing, the error
/// is [`Question::Topics`](crate::error::Question::Topics). `progress` counts the bytes of the files.
pub fn read(
    pieces: &[Piece<'_>],
    topics: Option<&PerStation<String>>,
    progress: &Progress,
    into: &mut Recording,
) -> Result<(), OpenError> {
    let mut intake = Intake::new(into, topics, progress);
    for piece in pieces {
        let bytes = piece.path.metadata().map_or(0, |metadata| metadata.len());
        read_piece(piece, bytes, &mut intake)?;
        intake.end_file()?;
    }
    intake.finish()
}

/// Poses of one topic of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseTopic {
    pub name: String,
    /// Poses in the order of the recording, each with a stamp.
    pub poses: Vec<StampedPose>,
    /// Fixes of a satellite receiver instead of poses, each with a stamp.
    pub fixes: Vec<NavSatFix>,
    /// True if the messages are positions: points may also be anything else.
    pub are_points: bool,
}

/// The poses of other systems in a recording.
#[derive(Debug)]
pub struct RecordedPoses {
    /// Topics with poses.
    pub topics: Vec<PoseTopic>,
    /// All topics, each with its type.
    pub all_topics: Vec<String>,
    /// Findings about losses.
    pub findings: Vec<Finding>,
}

/// Reads the poses of other systems (`nav_msgs/Odometry`, `PoseStamped`, `PointStamped`, `NavSatFix`) in one recording, by topic.
pub fn poses(pieces: &[Piece<'_>], progress: &Progress) -> Result<RecordedPoses, OpenError> {
    let mut unused = Recording::new(None, false);
    let mut intake = Intake::of_poses(&mut unused, progress);
    for piece in pieces {
        read_piece(piece, 0, &mut intake)?;
        intake.end_file()?;
    }
    let mut poses = intake.poses.take().unwrap_or_default();
    let mut fixes = std::mem::take(&mut intake.fixes);
    poses.resize_with(intake.stream.topics.len(), Vec::new);
    fixes.resize_with(intake.stream.topics.len(), Vec::new);
    let is_position = |kind: Kind| kind.is_position() || kind == Kind::NavSatFix;
    let names: Vec<(String, bool)> = (intake.stream.topics.iter())
        .map(|topic| (topic.name.clone(), topic.kind.is_some_and(is_position)))
        .collect();
    let all_topics = intake.stream.topics.iter();
    let all_topics =
        all_topics.map(|topic| format!("{} ({})", topic.name, topic.message_type)).collect();
    let transforms = std::mem::take(&mut intake.transforms).into_poses();
    drop(intake);
    let topics = names.into_iter().zip(poses.into_iter().zip(fixes));
    let topics = topics.map(|((name, are_points), (poses, fixes))| PoseTopic {
        name,
        poses,
        fixes,
        are_points,
    });
    let is_empty = |topic: &PoseTopic| topic.poses.is_empty() && topic.fixes.is_empty();
    let mut topics: Vec<PoseTopic> = topics.filter(|topic| !is_empty(topic)).collect();
    topics.extend(transforms.into_iter().map(|(name, poses)| PoseTopic {
        name,
        poses,
        fixes: Vec::new(),
        are_points: false,
    }));
    topics.sort_by_cached_key(|topic| natural_key(&topic.name));
    Ok(RecordedPoses { topics, all_topics, findings: unused.findings })
}

/// Returns the recording times of the first and the last message read (s, the recorder's clock); `None` without messages. Reads the
/// whole file.
pub fn span_s(piece: &Piece<'_>, progress: &Progress) -> Result<Option<[f64; 2]>, OpenError> {
    let mut unused = Recording::new(None, false);
    let mut intake = Intake::new(&mut unused, None, progress);
    // The bytes are counted when the file is read again for its content.
    read_piece(piece, 0, &mut intake)?;
    Ok(intake.span_s())
}

/// `counted` bytes are reported to the progress.
fn read_piece(piece: &Piece<'_>, counted: u64, intake: &mut Intake<'_>) -> Result<(), OpenError> {
    let io = |error| OpenError::Io { path: piece.path.to_owned(), error };
    let bytes = piece.path.metadata().map_err(io)?.len();
    let budget = Budget::of_file(bytes);
    intake.begin_file(piece.file, counted);
    let head = head(piece.path).map_err(io)?;
    if !head.starts_with(&inflate::ZSTD_MAGIC) {
        return read_container(piece.path, &head, &budget, intake);
    }
    let (inflated, damage) =
        inflate::to_temporary_file(piece.path, &budget, piece.file, intake.progress())?;
    if let Some(damage) = damage {
        intake.lost(0, damage);
    }
    let head = self::head(inflated.path()).map_err(io)?;
    read_container(inflated.path(), &head, &budget, intake)
}

fn read_container(
    path: &Path,
    head: &[u8],
    budget: &Budget,
    intake: &mut Intake<'_>,
) -> Result<(), OpenError> {
    let records = || {
        let io = |error| OpenError::Io { path: path.to_owned(), error };
        File::open(path).and_then(Positioned::new).map_err(io)
    };
    match recognise(head) {
        Some(Format::Ros1Bag) => ros1::read(records()?, budget, intake),
        Some(Format::Mcap) => mcap::read(records()?, budget, intake),
        Some(Format::Ros2Sqlite) => sqlite::read(path, intake),
        _ => Err(OpenError::file(
            intake.file(),
            "nothing can be read: the bag is cut off or damaged at its start",
            "copy it again from the recording computer",
        )),
    }
}

fn head(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut head = Vec::new();
    std::io::Read::read_to_end(&mut std::io::Read::take(File::open(path)?, HEAD_BYTES), &mut head)?;
    Ok(head)
}
