//! Comparison of trajectories of other systems (SLAM, odometry, GNSS) with a ground truth: a deployment's own trajectory, or
//! that of another system.
//!
//! ```text
//! files ──read──▶ EstimatedTrajectory
//! GroundTruth ──matched──▶ MatchedPose: ground truth at the estimate's times, or the estimate at a sparser ground truth's
//! both ──fit──▶ Fit ──errors──▶ Judged ──ranking, odd, agreement──▶ EstimatesJudgement
//! ```
//! [`fit`] estimates the time offset, the body's position in the vehicle, and the transform of the estimate's frame.
//! [`metrics`] are evo's, so that numbers are comparable with those of papers. The other modules add to evo's results: the
//! covariance of the ground truth itself ([`errors`]), the significance of differences between estimates at common instants and over
//! common paths ([`ranking`]), and spans in which the ground truth is wrong ([`odd`]).

mod agreement;
mod association;
mod common_errors;
mod convention_checks;
pub mod conventions;
mod delta;
pub mod errors;
pub mod fit;
mod ground_truth;
mod judge;
mod judged;
mod matched_pose;
pub mod metrics;
mod motion_pairs;
pub mod odd;
mod options;
mod plane;
mod pose_interpolation;
pub mod ranking;
#[cfg(test)]
pub mod simulated_odometry;
mod station_trajectory;
mod time_offset;
pub mod trajectory_summary;
mod truth_choice;
pub mod unfit;
mod unjudged;
mod varied_errors;

pub use agreement::AgreeingPair;
pub use convention_checks::add_findings_of_truth;
pub use delta::{Delta, RelativeOptions};
pub use ground_truth::GroundTruth;
pub use judge::{ConventionalFit, EstimatesJudgement, fit_with_convention, judge, judge_motions};
pub use judged::{Coverage, Judged, UnalignedErrors};
pub use matched_pose::MatchedPose;
pub use motion_pairs::NoMotions;
pub use options::{Association, Body, Options, TrajectoryAlignment};
pub use plane::Plane;
pub use resect_core::deployment::{
    EstimatedPose, EstimatedTrajectory, PoseCovariance, names_of_trajectories as names,
};
pub use station_trajectory::{NoStation, station_index};
pub use time_offset::offset_by_speeds_s;
pub use truth_choice::{TruthReason, choose_truth};
pub use unjudged::Unjudged;
