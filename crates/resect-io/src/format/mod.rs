//! The file formats: one file for each, and [`recognise`], which distinguishes them.
//!
//! Readers take text (or, for bags, a path) and return data with findings. The role of each file in a deployment is decided in
//! [`mod@crate::open`].

pub mod applied_transforms;
pub mod bag;
pub mod bonn_csv;
pub mod cartesian_tracks;
mod column_units;
pub mod control_points;
pub mod deployment_toml;
pub mod estimate;
mod format;
pub mod geodetic_table;
pub mod gps_time;
pub mod gsi;
pub mod jobxml;
pub mod joined_stamps;
pub mod kitti;
pub mod mapped_csv;
pub mod motion_capture;
pub mod nav_sat_fix;
pub mod nmea;
pub mod orientation_columns;
pub mod pillars;
pub mod polar_csv;
mod pose_columns;
pub mod pose_covariance;
pub mod pose_stamps;
pub mod pose_table;
mod recognise;
pub mod rig_files;
pub mod rtklib_pos;
pub mod survey;
pub mod surveyed_points;
pub mod table;
mod text_chunks;
pub mod text_encoding;

pub use format::{Format, SESSION_KEY};
pub use recognise::recognise;
pub use text_chunks::BYTE_ORDER_MARK;
