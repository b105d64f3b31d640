//! Plausibility of the numbers of a recording as radians, metres, seconds, and readings.
//!
//! Each column of each station is checked alone, before any calibration. Errors that no column shows alone (feet, a few degrees of
//! azimuth) are left to the checks of the result.

mod check;
mod impossible;
mod station_sense;
#[cfg(test)]
mod tests;
mod units;

pub use check::check;
pub use impossible::Impossible;
pub use station_sense::StationSense;
