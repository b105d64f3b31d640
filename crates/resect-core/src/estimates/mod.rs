//! Trajectories that other systems estimated, held against a deployment's own: SLAM, odometry, GNSS.
//!
//! ```text
//! files ──read──▶ Estimate ──┐
//! Analysis ──reference──▶ ground truth at the estimate's times ──fit──▶ Fit ──errors──▶ Judged ──ranking, odd──▶ Judgement
//! ```
//! [`fit`] finds what the two do not share: the zero of the clocks, where the estimate's body is in the vehicle, and the
//! estimate's frame. [`metrics`] are evo's, so that numbers compare with those of papers. What evo cannot say comes after it:
//! how much of an error the ground truth itself leaves open ([`errors`]), whether one estimate is better than another by more
//! than chance ([`ranking`]), and where the ground truth is the odd one out ([`odd`]).

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

pub use estimate::{Estimate, EstimatedPose, names};
pub use judge::{Judged, Judgement, RELATIVE_M, judge};
pub use options::{Alignment, Body, Options};
pub use unjudged::Unjudged;
