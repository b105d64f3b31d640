//! Method D: the dynamic inter-prism calibration.
//!
//! Minimises Σ (‖q1−T12 q2‖−α)² + (‖q1−T13 q3‖−β)² + (‖T12 q2−T13 q3‖−γ)² over the translation and yaw of
//! stations 2 and 3 (Vaidis et al. 2022, eq. (3)).
//!
//! The way to the answer: thinned triplets compressed to a [`squared_cost`] that does not depend on their number → a
//! prior ([`closed_form`] or [`prior_search`]) → [`search`] of all its minima → these on the exact cost, the best one
//! and its mirror twin finished on all triplets ([`minima`]; [`normal_equations`] is the one fused pass over the data)
//! → [`mirror`] decides between the two → [`uncertainty`] → [`observability`] and [`drive_shape`] → [`diagnosis`].
//! The [`clock_check`] looks for clock offsets that bias the answer. [`mod@solve`] runs method D; [`mod@solve_jointly`] runs
//! the joint estimate of three prisms, whose minima and verdict are computed in the same way ([`joint_answer`]).
//! [`mod@foresee`] predicts an answer before the drive.

mod centred;
mod clock_check;
mod closed_form;
mod compression;
mod diagnosis;
pub mod drive_shape;
mod foresee;
pub mod gross_errors;
mod joint_answer;
mod levenberg_marquardt;
mod minima;
mod mirror;
mod motion_in_words;
mod normal_equations;
pub mod observability;
mod prior_search;
mod published;
mod search;
mod solve;
mod solve_jointly;
mod squared_cost;
mod sums;
mod twins;
mod uncertainty;
mod unjudged;
mod used;
mod valley;

pub use centred::{CentredTriplets, Parameters};
pub use closed_form::closed_form_priors;
pub use foresee::{Foreseen, foresee};
pub use levenberg_marquardt::{Minimum, minimise};
pub use normal_equations::{NormalEquations, distance_pulls};
use observability::Observability;
pub use prior_search::{PriorSearch, SearchRun};
pub use solve::solve;
pub use solve_jointly::solve_jointly;
pub use squared_cost::SquaredCost;
pub use twins::Twins;

use super::{Basin, Mirror};
use crate::geometry::LevelTransform;

/// Eight unknowns, three residuals a triplet: below this there is nothing to average.
const FEWEST_TRIPLETS: usize = 10;
/// Two solutions are the same minimum within these; the paper's limits for its prior.
pub const SAME_TRANSLATION_M: f64 = 0.05;
pub const SAME_YAW_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// Details of an answer from inter-prism distances: of method D, or of a joint estimate of three prisms.
#[derive(Clone, Debug)]
pub struct InterPrismDetails {
    /// The minimum that is the answer.
    pub basin: Basin,
    pub mirror: Mirror,
    pub observability: Observability,
    /// Every distinct minimum in order of cost, the answer and its twin among them; a valley counts once. The costs of
    /// the others come from about a thousand triplets.
    pub basins: Vec<Basin>,
    /// What the search of the prior did, when it was asked for.
    pub prior_search: Option<PriorSearch>,
}

impl InterPrismDetails {
    /// What one of the minima is.
    pub fn role(&self, basin: &Basin) -> &'static str {
        if *basin == self.basin {
            "answer"
        } else if self.mirror.twin.as_ref() == Some(basin) {
            "mirror twin"
        } else {
            "other"
        }
    }

    /// What one of the minima costs over what the answer costs.
    pub fn cost_ratio(&self, basin: &Basin) -> f64 {
        basin.mean_square_m2 / self.basin.mean_square_m2
    }
}

/// Whether two solutions are the same minimum.
pub fn same_solution(a: &[LevelTransform; 3], b: &[LevelTransform; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| {
        (a.translation_m - b.translation_m).norm() < SAME_TRANSLATION_M
            && crate::geometry::wrap_to_pi(a.yaw_rad - b.yaw_rad).abs() < SAME_YAW_RAD
    })
}

fn basin(data: &CentredTriplets, minimum: &Minimum) -> Basin {
    Basin {
        station1_from_station: data.transforms(&minimum.parameters),
        mean_square_m2: minimum.normal.cost / (3 * data.len()) as f64,
        height_differences_m: data.height_differences_m(&minimum.parameters),
    }
}
