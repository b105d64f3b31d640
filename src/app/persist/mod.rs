//! What outlives the window: preferences, sessions, and what was open when the program stopped.
//!
//! Plain data and plain functions. [`session`] and [`preferences`] are the files, [`hashes`] tells whether inputs
//! changed, [`autosave`] keeps the running window's session safe, [`last`] what was open before, [`writer`] writes without a frame waiting, and
//! [`super::keeping`] is all that a window needs of it.

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
