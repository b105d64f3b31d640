//! Conventions that the data of an estimate suggests.
//!
//! A wrong convention looks like a wrong estimate. Each suspicion is a finding with the numbers that show it and the flag that
//! sets it. Data is changed only by a stated [`Convention`](super::conventions::Convention).
//!
//! ```text
//! poses ──before the fit──▶ repeated_poses, jumps, mixed_bodies, exchanged, unit_of_length, misread_degrees,
//!                           misread_positions, time_scale, handedness
//!       ──after the fit───▶ orientation_search, orientation_delay, scale, copies (between estimates)
//! ```

mod block_comparison;
mod checks;
mod copies;
mod exchanged;
mod handedness;
mod jumps;
mod lever_equations;
mod misread_degrees;
mod misread_positions;
mod mixed_bodies;
mod orientation_delay;
mod orientation_search;
mod position_truth;
mod repeated_poses;
mod rounding;
mod scale;
mod time_scale;
mod travel_direction;
mod unit_of_length;

pub use checks::{add_findings_of_truth, after_fit, before_fit};
pub use copies::{ComparedEstimate, CopiedEstimate, copies, sources};

#[cfg(test)]
mod tests;
