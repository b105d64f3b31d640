//! Recordings of ROS 1 and ROS 2: one file for each container, and the messages in them.
//!
//! | file | content |
//! |---|---|
//! | [`ros1`] | the container of ROS 1 |
//! | [`sqlite`], [`mcap`] | the containers of ROS 2 |
//! | [`container`] | bytes with a position, and continuation after damage |
//! | [`inflate`] | bz2, lz4, zstd, with a limit |
//! | [`messages`], [`wire`], [`json_messages`] | fields of the messages, and their encoding |
//! | [`stream`] | conversion of messages into readings, from a recording or live |
//! | [`intake`], [`outcome`] | adding messages to the recording; the final findings |
//!
//! A container is recognised by its first bytes, as is compression with zstd by file (`.db3.zstd`, `.mcap.zstd`) or by message;
//! `metadata.yaml` is not needed. Memory grows with the readings alone: no chunk and no file is loaded whole. No claimed length is
//! allocated before the bytes are read. Recovery of interrupted recordings is tested on complete recordings that were cut and
//! damaged, not on those of a real crash.

mod bag;
mod container;
mod inflate;
mod intake;
pub mod json_messages;
mod mcap;
pub mod messages;
mod outcome;
mod ros1;
mod sqlite;
pub mod stream;
mod transform_tree;
pub mod wire;

pub use self::bag::{
    Piece, PoseTopic, RecordedPoses, poses, read, recognise, recognise_compressed, span_s,
};
pub use self::intake::natural_key;
