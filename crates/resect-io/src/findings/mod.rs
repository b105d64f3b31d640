//! Findings of opening files: one constructor for each kind, with its message.

pub mod bags;
pub mod control_points;
mod examples;
pub mod positions;
pub mod readings;
pub mod rig;
pub mod surveys;
pub mod tracks;
pub mod trajectories;

pub use examples::examples;
