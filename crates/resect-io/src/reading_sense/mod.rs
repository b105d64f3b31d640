//! Whether the numbers of a recording can be what they are taken for: radians, metres, seconds, and readings at all.
//!
//! Judged by each station and column alone, before any calibration. What no column tells by itself (feet, a few degrees
//! of azimuth) is left to the answer's own checks.

mod check;
mod impossible;
mod station_sense;
#[cfg(test)]
mod tests;
mod units;

pub use check::check;
pub use impossible::Impossible;
pub use station_sense::StationSense;
