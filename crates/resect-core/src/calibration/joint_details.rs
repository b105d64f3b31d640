//! Details of a joint estimate.

use super::dynamic_gcp::DynamicGcpDetails;
use super::inter_prism::InterPrismDetails;
use super::joint::JointEstimate;

/// Details of a joint estimate, for three prisms or for one.
#[derive(Clone, Debug)]
pub struct JointDetails {
    /// `None` where the data does not determine all unknowns; the answer is then that of the published method.
    pub estimate: Option<JointEstimate>,
    pub targets: JointTargets,
}

/// Properties of the answer that depend on the number of prisms.
#[derive(Clone, Debug)]
pub enum JointTargets {
    /// Minima, mirror twin and observability on the corrected readings.
    ThreePrisms(InterPrismDetails),
    /// Alignment of the tracks that the estimate starts from.
    OnePrism(DynamicGcpDetails),
}
