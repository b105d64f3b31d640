//! Saved data: preferences, sessions, and the session of a program that stopped.
//!
//! Plain data and functions. [`session`] and [`preferences`] are the files, and [`hashes`] detects changed inputs. [`autosave`] saves the
//! running window's session, [`last`] the session open before, and [`writer`] writes without blocking a frame. [`super::saved_state`] combines
//! them for a window.

pub mod autosave;
mod damaged_file;
mod folders;
pub mod hashes;
pub mod last;
pub mod preferences;
pub mod session;
pub mod session_file;
mod stored;
mod writer;

pub use folders::Folders;
