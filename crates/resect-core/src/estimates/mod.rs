//! Comparison of trajectories of other systems (SLAM, odometry, GNSS) with a deployment's own.
//!
//! ```text
//! files ──read──▶ EstimatedTrajectory
//! Analysis ──reference──▶ ground truth at the estimate's times
//! both ──fit──▶ Fit ──errors──▶ Judged ──ranking, odd──▶ EstimatesJudgement
//! ```
//! [`fit`] estimates the time offset, the body's position in the vehicle, and the transform of the estimate's frame.
//! [`metrics`] are evo's, so that numbers are comparable with those of papers. The other modules add to evo's results: the
//! covariance of the ground truth itself ([`errors`]), the significance of differences between estimates ([`ranking`]), and
//! spans in which the ground truth is wrong ([`odd`]).

pub mod errors;
mod estimate;
pub mod fit;
mod judge;
pub mod metrics;
pub mod odd;
mod options;
pub mod ranking;
pub mod reference;
mod time_offset;
pub mod unfit;
mod unjudged;

pub use estimate::{EstimatedPose, EstimatedTrajectory, names};
pub use judge::{EstimatesJudgement, Judged, RELATIVE_M, judge};
pub use options::{Body, Options, TrajectoryAlignment};
pub use unjudged::Unjudged;
