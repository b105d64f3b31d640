//! Conventions that the data of an estimate suggests.
//!
//! A wrong convention looks like a wrong estimate. Each suspicion is a finding with the numbers that show it and the flag that
//! sets it. Data is changed only by a stated [`Convention`](super::conventions::Convention).
//!
//! ```text
//! poses ──before the fit──▶ repeated_poses, mixed_bodies, exchanged, unit_of_length, time_scale
//!       ──after the fit───▶ orientation_search, scale, copies (between estimates)
//! ```

mod checks;
mod copies;
mod exchanged;
mod mixed_bodies;
mod orientation_search;
mod position_truth;
mod repeated_poses;
mod rounding;
mod scale;
mod time_scale;
mod travel_direction;
mod unit_of_length;

pub use checks::{after_fit, before_fit};
pub use copies::{ComparedEstimate, CopiedEstimate, copies, sources};

#[cfg(test)]
mod tests;
