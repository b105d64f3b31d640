//! Files that are either the old one or the new one, never half of it, whenever the program or the machine stops.
//!
//! Everything that the program writes goes through here: first a hidden file beside it ([`part`]), then its name.

mod error;
mod part;
mod write;

pub use error::WriteError;
pub use part::target_of_part;
pub use write::{Ready, make_folder, place_all, ready, ready_with, write, write_with};
