//! Findings of opening files: one constructor with its message for each kind.

pub mod bags;
pub mod control_points;
mod examples;
pub mod gnss;
pub mod kinds;
pub mod positions;
pub mod readings;
pub mod rig;
pub mod surveys;
pub mod tracks;
pub mod trajectories;

pub use examples::examples;
