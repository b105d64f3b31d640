//! A deployment while it is driven: readings from the network, live answers, and the decision if the drive is long enough.
//!
//! # Modules, from the ground up
//! A module imports only from those above it in this table (`tests/structure`).
//!
//! | module | content | next change |
//! |---|---|---|
//! | [`event`] | events of any source: channels and messages of ROS | |
//! | [`foxglove`], [`bonn`], [`replay`] | the sources | another stream: a file that makes [`event::Event`]s, and its choice in `connect.rs`; another message of a stream: `crates/resect-io/src/format/bag/messages.rs`, then its arm in `engine.rs` |
//! | [`connect`] | the connection to a source over the network, with reconnection | |
//! | [`recorder`] | the recording of all events as MCAP | |
//! | [`kinds`], [`findings`] | the warnings of a live drive, one constructor for each kind | |
//! | [`status`] | the state of each station | |
//! | [`judged`] | the verdict of an answer in the field | |
//! | [`next`] | the advised next manoeuvre | |
//! | [`coach`] | the decision if the drive is long enough, and the advice | |
//! | [`warnings`] | warnings in the field | a warning: its kind in `kinds.rs`, its constructor in `findings.rs`, its condition here |
//! | [`pace`] | the rate of answers | |
//! | [`view`] | the state of a live deployment at an instant, as plain data | |
//! | [`closing`] | the answer to all readings, at the end | |
//! | [`engine`] | the state without threads: takes events, returns snapshots and views | |
//! | [`session`] | the threads, behind one handle | |
//!
//! The tracks grow in [`resect_io::growing::Growing`], which makes the same deployment from messages as from a bag of
//! them. Answers are those of [`resect_core::analysis::Analyst`], as for any other deployment.

pub mod bonn;
mod closing;
pub mod coach;
pub mod connect;
pub mod engine;
pub mod event;
pub mod findings;
pub mod foxglove;
pub mod judged;
pub mod kinds;
mod next;
pub mod pace;
pub mod recorder;
pub mod replay;
pub mod session;
pub mod status;
pub mod view;
pub mod warnings;

pub use self::closing::Closing;
pub use self::engine::Engine;
pub use self::pace::Pace;
pub use self::session::{Feed, Finished, LiveError, Session, Wanted, around};
pub use self::view::{Link, View};
