//! Extrinsic calibration of two bodies by their trajectories, or of a body and an antenna.
//!
//! Body a has poses; b has poses, or positions only. The fit of [`estimates`](crate::estimates) gives the pose of b in a, the offset of the
//! clocks and the ratio of the lengths, beside frames that wander against each other. The halves of the drive are fitted
//! too: if they contradict each other, no σ of the whole is right. [`AdvisedMotion`] is the advice for a direction that the motion determines weakly.

mod advised_motion;
mod driven_motion;
mod errors;
mod estimate_extrinsics;
mod halves;
mod lever_direction;
mod solution;
#[cfg(test)]
mod tests;

pub use advised_motion::AdvisedMotion;
pub use driven_motion::DrivenMotion;
pub use errors::NoExtrinsics;
pub use estimate_extrinsics::{
    Extrinsics, Weakness, estimate_extrinsics, extrinsics_with_truth, weakness,
};
pub use halves::{HalvesDifference, HalvesOutcome};
pub use lever_direction::LeverDirection;
pub use solution::Solution;
