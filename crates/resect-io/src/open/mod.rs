//! Opening of a path as a deployment: its files, the role of each, and missing ones.

mod bags;
mod cartesian;
mod clock_jump;
mod collection;
mod combine;
mod control_points;
mod copies;
mod dated;
mod found;
mod gnss;
mod reading;
mod rig;
mod station_in_name;
mod stations;
mod surveys;
mod tables;
mod track_checks;
mod tracks;

pub use collection::holds_many;
pub use combine::{combine, combine_without_tracks, open, open_files};
pub use found::{FOLDER_DEPTH, FoundFile, find, in_memory, list_folder};
pub use stations::complete_stations;
pub use tracks::of_recording as tracks_of_recording;
