//! Files of robotic total stations: formats, folders that make a deployment, and atomic writing.
//!
//! [`Source::open`] reads a [`Deployment`](resect_core::deployment::Deployment) from a path; [`open()`] is its short form.
//!
//! # Modules, from the ground up
//! A module imports only from those above it in this table (`tests/structure`).
//!
//! | module | content | next change |
//! |---|---|---|
//! | [`windows`] | differences of Windows: forms of paths, files that another program has open | |
//! | [`atomic`] | atomic writing: a crash leaves the old file or the new one | a remedy for a failed write: `atomic/error.rs` |
//! | [`error`] | errors of opening, and questions that only the user can answer | |
//! | [`skipped_rows`] | rows of tables that are not valid | |
//! | [`gnss_solution`] | solutions of a GNSS receiver: kind, covariance, choice | |
//! | [`findings`] | findings of opening, one constructor for each kind | a new finding: a constructor here, its kind in `kinds.rs` |
//! | [`reading_sense`] | plausibility of numbers as radians, metres and seconds | |
//! | [`recording`] | conversion of records into tracks: impossible readings are counted and left out | |
//! | [`format`](mod@format) | one file a format, `bag/` for the bags, `rig_files.rs` for the rig; `recognise.rs` distinguishes them by content | another message of a bag: `bag/messages.rs`, `bag/stream.rs`, then a field of the deployment; a format (a new GNSS format, say): a file here, a variant of `Format` in `format.rs`, a line in `recognise.rs`, its part in `open/` (GNSS: `open/gnss.rs`, `open/found.rs`); `examples/add_a_format.rs` of the root package shows a reader |
//! | [`rounding`] | coordinates that are rounded too much | |
//! | [`local_positions`] | positions of GNSS receivers in metres about the first | another format: a reader that returns a `GnssTrack`, its call in `estimate_file.rs` |
//! | [`estimate_file`] | trajectories of other systems | a format: a layout in `format/pose_table.rs` |
//! | [`antenna_poses`] | poses of a body from several GNSS antennas | |
//! | [`extras`] | files and overrides that the user names beside a deployment | |
//! | [`open`](mod@open) | opening of a folder as a deployment: the role of each file | a check of complete tracks: `open/track_checks.rs` |
//! | [`sample`], [`source`] | the built-in deployments; the source of a deployment | |
//! | [`growing`] | a deployment whose messages are still arriving | |
//! | [`what_is`] | recognition of a dropped path | |
//! | [`truth`] | opening of a ground truth: a deployment or a trajectory | |
//! | [`evaluation_files`] | trajectories without a deployment: one is the ground truth of the others | |
//! | [`override_changes`] | changed overrides in words | |
//! | [`file_mark`] | hashes by which a session recognises its files | |
//! | [`plan_file`], [`way_file`], [`settings_file`], [`drives_file`] | plans, driven paths, settings, drives to evaluate | |
//! | [`simulation_files`] | a simulated deployment as the files of a real one | |

pub mod antenna_poses;
pub mod atomic;
pub mod drives_file;
pub mod error;
pub mod estimate_file;
pub mod evaluation_files;
mod extras;
pub mod file_mark;
pub mod findings;
pub mod format;
pub mod gnss_solution;
pub mod growing;
mod local_positions;
pub mod open;
pub mod override_changes;
pub mod plan_file;
mod reading_sense;
pub mod recording;
mod rounding;
pub mod sample;
pub mod settings_file;
pub mod simulation_files;
pub mod skipped_rows;
pub mod source;
pub mod truth;
pub mod way_file;
pub mod what_is;
pub mod windows;

pub use error::OpenError;
pub use open::{open, open_files};
pub use sample::Sample;
pub use source::Source;
