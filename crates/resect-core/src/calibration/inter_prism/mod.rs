//! Method D: the dynamic inter-prism calibration.
//!
//! Minimises Σ (‖T_a q_a − T_b q_b‖ − d_ab)² over the translation and yaw of all stations but the first (Vaidis et al. 2022, eq. (3),
//! with three stations). The sum is over the triplets and the pairs of stations of a [`prism_network`]. Stations that follow the
//! same prism have ‖T_a q_a − T_b q_b‖² instead.
//!
//! Steps of the solution:
//!
//! 1. [`squared_cost`] compresses thinned triplets to a cost that does not depend on their number.
//! 2. [`closed_form`] or [`prior_search`] computes a prior.
//! 3. [`search`] finds all minima of the compressed cost.
//! 4. [`minima`] refines them on the exact cost, the best one and its mirror twin on all triplets. [`distance_pass`] is the one
//!    fused pass over the data.
//! 5. [`mirror`] decides between the two.
//! 6. [`uncertainty`], [`observability`] and [`drive_shape`] evaluate the answer.
//! 7. [`diagnosis`] judges it.
//!
//! The [`clock_check`] detects clock offsets that bias the answer. [`mod@solve`] runs method D. [`mod@solve_jointly`] runs the
//! joint estimate of several prisms, whose minima and verdict are computed by the same steps ([`joint_answer`]). [`followed_another`]
//! recognises a station that followed another prism for some time. [`mod@foresee`]
//! predicts an answer before the drive.

mod basin;
mod centred;
mod clock_check;
mod closed_form;
mod compression;
mod diagnosis;
mod distance_pass;
pub mod drive_shape;
mod first_solution;
mod followed_another;
mod foresee;
pub mod gross_errors;
mod inter_prism_details;
mod joint_answer;
mod joint_minimum;
mod levenberg_marquardt;
mod minima;
mod mirror;
mod mirror_twin;
mod motion_in_words;
#[cfg(test)]
mod networks_tests;
mod normal_equations;
pub mod observability;
mod pair_sums;
mod prior_search;
mod prism_network;
mod published;
mod same_solution;
mod screening;
mod search;
mod solve;
mod solve_jointly;
mod squared_cost;
mod systematic_errors;
mod twins;
mod uncertainty;
mod unjudged;
mod used;
mod valley;

pub use basin::Basin;
use basin::basin;
use centred::FEWEST_TRIPLETS;
pub use centred::{CentredTriplets, Parameters};
pub use closed_form::closed_form_priors;
pub use first_solution::{FirstSolution, StartingPoint};
pub use foresee::{Foreseen, foresee};
pub use inter_prism_details::InterPrismDetails;
pub use levenberg_marquardt::{Minimum, minimise};
pub use mirror::DECISIVE_COST_RATIO;
pub use mirror_twin::{Mirror, ResolvedBy};
pub use normal_equations::NormalEquations;
pub use prior_search::{PriorSearch, SearchRun};
pub use prism_network::{FollowedPair, PrismNetwork};
pub use same_solution::{SAME_TRANSLATION_M, SAME_YAW_RAD, same_solution};
pub use solve::solve;
pub use solve_jointly::solve_jointly;
pub use squared_cost::SquaredCost;
pub use twins::Twins;
