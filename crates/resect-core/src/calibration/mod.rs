//! Calibration of the stations' extrinsics from triplets, with uncertainty and verdict.
//!
//! [`solve()`] returns the [`Calibration`] by a method. The paper's four methods have modules of their own: A [`two_point`], B
//! [`static_gcp`], C [`dynamic_gcp`], D [`inter_prism`]. The [`joint`] estimate extends them and includes the paper's answer.
//! [`Offer`] lists the methods that the data allows.

mod calibration;
mod checks;
mod clocks_in_words;
mod common_errors;
mod control_points_alone;
mod details;
mod disagreement;
pub mod dynamic_gcp;
mod error;
mod estimate;
mod evidence;
pub mod followed_prisms;
mod gross_error_limit;
pub mod instrument;
pub mod inter_prism;
pub mod joint;
mod joint_data;
mod joint_failure;
mod judgement;
mod method;
mod method_answer;
#[cfg(test)]
mod methods_tests;
pub mod misfits;
mod moving_triplets;
mod numbers;
mod point_to_point;
mod recommendation;
mod sense;
mod settings;
mod solve;
pub mod static_gcp;
pub mod time_blocks;
mod track_clocks;
mod transform_sigma;
pub mod two_point;
mod verdict;
mod witness;

pub use calibration::Calibration;
pub use details::{Details, JointDetails};
pub use disagreement::{Disagreement, disagreements, moved_m};
pub use error::CalibrationError;
pub use estimate::{Estimate, Quantity, SUPPORTED_SIGMAS};
pub use evidence::Evidence;
pub use instrument::ErrorSizes;
pub use inter_prism::{Basin, Mirror, ResolvedBy};
pub use joint_failure::JointFailure;
pub use method::{Method, Offer};
pub use misfits::distance_errors_m;
pub use moving_triplets::{Clock, MovingTriplets, velocity_m_per_s, with_clocks};
pub use numbers::{CALIBRATION_NUMBERS, SIGMA_DISTANCES};
pub use recommendation::{Recommendation, RecommendationProof, RecommendationReason, recommend};
pub use settings::{Alignment, CalibrationSettings, PriorMethod};
pub use solve::{solve, solve_while};
pub use transform_sigma::TransformSigma;
pub use verdict::Verdict;
pub use witness::Witness;
