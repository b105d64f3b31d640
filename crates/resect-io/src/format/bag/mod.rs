//! Recordings of ROS 1 and ROS 2: bags, one file a container, and what their messages say.
//!
//! | file | what |
//! |---|---|
//! | [`ros1`] | the container of ROS 1 |
//! | [`sqlite`], [`mcap`] | those of ROS 2 |
//! | [`container`] | bytes with a position, and how a walk goes on after damage |
//! | [`inflate`] | bz2, lz4, zstd, under a cap |
//! | [`messages`], [`wire`] | which fields the messages have, and how they are written |
//! | [`stream`] | what message after message says, in a recording or live |
//! | [`intake`], [`outcome`] | messages into the recording; what is said of them in the end |
//!
//! A container is told by its first bytes, and so is what zstd compressed by file (`.db3.zstd`, `.mcap.zstd`) or by message: what
//! `metadata.yaml` says of that is not needed. Memory goes with the readings that are kept: no chunk and no file is held
//! in it, and no length that a header claims is allocated before as many bytes are there. Recovery of recordings that were killed
//! was tried on whole recordings that were cut and damaged, not on those of a real crash.

mod bag;
mod container;
mod inflate;
mod intake;
mod mcap;
pub mod messages;
mod outcome;
mod ros1;
mod sqlite;
pub mod stream;
pub mod wire;

pub use self::bag::{Piece, PoseTopic, poses, read, recognise, recognise_compressed, span_s};
pub use self::intake::natural_key;
