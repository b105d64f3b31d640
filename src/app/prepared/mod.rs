//! Precomputed data for fast drawing: series of the plots at several resolutions, gaps, clouds of points, and the trees for picking.

pub mod analyser;
pub mod beside;
pub mod channels;
mod clock_series;
mod cloud;
pub mod control_points;
pub mod dimension;
pub mod gaps;
pub mod pick;
pub mod placing;
pub mod plots;
mod pyramid;
pub mod raw_readings;
pub mod rig_at;
mod running;
pub mod series;
mod track_series;
pub mod way;

pub use cloud::{Cloud, CloudMaker, Clouds, nearest_triplets, time_origin_s};
pub use pick::TimedPoint;
pub use plots::PreparedPlots;
pub use raw_readings::{Quantity, RawReadings, StationReadings};
pub use running::Piece;
