//! Trajectories for other programs: TUM (`evo` reads it), CSV with the covariance, `nav_msgs/Odometry` in bags of ROS 1 and
//! in MCAP, and PLY.

mod file;
mod mcap_bag;
mod odometry;
mod ply;
mod ros1_bag;

pub use file::{
    FileKind, STATION1, Unwritable, csv, file, prism_csv, prism_file, prism_tum, station_file,
    station_tum, tum,
};
