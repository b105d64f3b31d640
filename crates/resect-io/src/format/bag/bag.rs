//! Reading of a recording: its container by its first bytes, its pieces after each other.

use std::fs::File;
use std::path::Path;

use super::container::Positioned;
use super::inflate::Budget;
use super::intake::{Intake, natural_key};
use super::messages::StampedPose;
use super::{inflate, mcap, ros1, sqlite};
use crate::error::OpenError;
use crate::format::format::Format;
use crate::recording::Recording;
use resect_core::deployment::Finding;
use resect_core::progress::Progress;

/// One file of a recording: where it lies, and what it is called in findings.
#[derive(Clone, Copy, Debug)]
pub struct Piece<'a> {
    pub path: &'a Path,
    pub file: &'a str,
}

/// Bytes at a file's beginning that are enough to tell what it is.
const HEAD_BYTES: u64 = 4096;

/// What a file is by its first bytes (up to [`HEAD_BYTES`]), if it is anything of a bag.
pub fn recognise(head: &[u8]) -> Option<Format> {
    Some(if head.starts_with(b"#ROSBAG") {
        Format::Ros1Bag
    } else if head.starts_with(mcap::MAGIC) {
        Format::Mcap
    } else if head.starts_with(sqlite::MAGIC) {
        if sqlite::may_be_a_bag(head) {
            Format::Ros2Sqlite
        } else {
            Format::Ignored("an SQLite database, but no ROS 2 bag")
        }
    } else if sqlite::is_log(head) {
        Format::Ignored("left by an interrupted recording; read with the bag beside it")
    } else if head.starts_with(&inflate::ZSTD_MAGIC) {
        Format::Ignored("compressed with zstd, but no ROS 2 bag")
    } else if head.starts_with(b"rosbag2_bagfile_information:") {
        Format::RosbagMetadata
    } else {
        return None;
    })
}

/// What a file is that may be compressed as a whole; `None` where it is not, or not a bag.
pub fn recognise_compressed(head: &[u8], path: &Path) -> Option<Format> {
    if !head.starts_with(&inflate::ZSTD_MAGIC) {
        return None;
    }
    let inner = inflate::head(File::open(path).ok()?, HEAD_BYTES);
    recognise(&inner).filter(|format| format.is_bag())
}

/// Every reading of one recording into `into`, its pieces after each other.
///
/// `topics` are those of stations 1, 2, 3 where positions do not name their station; without them, and without messages that do,
/// the answer is [`Question::Topics`](crate::error::Question::Topics). `progress` counts the bytes of the files.
pub fn read(
    pieces: &[Piece<'_>],
    topics: Option<&[String; 3]>,
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

/// The poses of one topic of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseTopic {
    pub name: String,
    /// In the order of the recording, each with a stamp.
    pub poses: Vec<StampedPose>,
}

/// The poses of other systems (`nav_msgs/Odometry`, `PoseStamped`) in one recording, by topic, and what was lost on the way.
pub fn poses(
    pieces: &[Piece<'_>],
    progress: &Progress,
) -> Result<(Vec<PoseTopic>, Vec<Finding>), OpenError> {
    let mut unused = Recording::default();
    let mut intake = Intake::of_poses(&mut unused, progress);
    for piece in pieces {
        read_piece(piece, 0, &mut intake)?;
        intake.end_file()?;
    }
    let poses = intake.poses.take().unwrap_or_default();
    let names: Vec<String> = intake.stream.topics.iter().map(|topic| topic.name.clone()).collect();
    drop(intake);
    let topics = names.into_iter().zip(poses).map(|(name, poses)| PoseTopic { name, poses });
    let mut topics: Vec<PoseTopic> = topics.filter(|topic| !topic.poses.is_empty()).collect();
    topics.sort_by_cached_key(|topic| natural_key(&topic.name));
    Ok((topics, unused.findings))
}

/// When the first and the last of the messages that are read were recorded (s, the recorder's clock); `None` where there is none.
/// Reads the whole file.
pub fn span_s(piece: &Piece<'_>, progress: &Progress) -> Result<Option<[f64; 2]>, OpenError> {
    let mut unused = Recording::default();
    let mut intake = Intake::new(&mut unused, None, progress);
    // The bytes count when they are read for good.
    read_piece(piece, 0, &mut intake)?;
    Ok(intake.span_s())
}

/// `counted` bytes are told to the progress.
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
            "nothing of a bag can be read, it is cut off or damaged at its very start",
            "copy it again from where it was recorded",
        )),
    }
}

fn head(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut head = Vec::new();
    std::io::Read::read_to_end(&mut std::io::Read::take(File::open(path)?, HEAD_BYTES), &mut head)?;
    Ok(head)
}
