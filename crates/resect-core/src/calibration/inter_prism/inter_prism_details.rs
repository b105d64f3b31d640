//! Details of an answer from inter-prism distances.

use super::basin::Basin;
use super::mirror_twin::Mirror;
use super::observability::Observability;
use super::prior_search::PriorSearch;
use crate::calibration::TransformSigma;
use crate::network::PerStation;

/// Details of an answer from inter-prism distances: of method D, or of a joint estimate of several prisms.
#[derive(Clone, Debug)]
pub struct InterPrismDetails {
    /// Minimum of the answer.
    pub basin: Basin,
    pub mirror: Mirror,
    pub observability: Observability,
    /// All distinct minima in order of cost, with the answer and its twin; one for each valley. The costs of the others are from
    /// about a thousand triplets.
    pub basins: Vec<Basin>,
    /// σ by the noise of this drive alone; `None` of an unobservable answer. Mistakes are looked for with it: they are larger than errors of
    /// instruments, but in a small rig not larger than what these may cause.
    pub noise_sigma: Option<PerStation<TransformSigma>>,
    /// The search of the prior; `None` if it was not requested.
    pub prior_search: Option<PriorSearch>,
}

impl InterPrismDetails {
    /// Returns the role of one of the minima.
    pub fn role(&self, basin: &Basin) -> &'static str {
        if *basin == self.basin {
            "answer"
        } else if self.mirror.twin.as_ref() == Some(basin) {
            "mirror twin"
        } else {
            "other"
        }
    }

    /// Returns the cost of one of the minima over that of the answer.
    pub fn cost_ratio(&self, basin: &Basin) -> f64 {
        basin.mean_square_m2 / self.basin.mean_square_m2
    }
}
