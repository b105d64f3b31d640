//! Atomic writing: a crash of the program or the machine leaves either the old file or the new one, never half a file.
//!
//! All files are written by this module: first a hidden temporary file beside the target ([`part`]), which then replaces the target.

mod error;
mod part;
mod write;

pub use error::WriteError;
pub use part::target_of_part;
pub use write::{Ready, make_folder, place_all, ready, ready_with, write, write_with};
