//! Details of a calibration by method.

use super::dynamic_gcp::DynamicGcpDetails;
use super::inter_prism::InterPrismDetails;
use super::joint_failure::JointResult;
use super::static_gcp::StaticGcpDetails;
use super::two_point::TwoPointDetails;

/// Details of a joint estimate, for three prisms or for one.
#[derive(Clone, Debug)]
pub struct JointDetails {
    /// The estimate, or the reason why the answer is the published one.
    pub estimate: JointResult,
    pub targets: JointTargets,
}

/// Properties of the answer that depend on the number of prisms.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "its owner is in a box")]
pub enum JointTargets {
    /// Minima, mirror twin and observability on the corrected readings.
    ThreePrisms(InterPrismDetails),
    /// Alignment of the tracks from which the estimate starts.
    OnePrism(DynamicGcpDetails),
}

/// Details of an answer by method.
#[derive(Clone, Debug)]
pub enum Details {
    TwoPoint(TwoPointDetails),
    StaticGcp(StaticGcpDetails),
    DynamicGcp(DynamicGcpDetails),
    InterPrism(Box<InterPrismDetails>),
    Joint(Box<JointDetails>),
}

impl From<TwoPointDetails> for Details {
    fn from(details: TwoPointDetails) -> Self {
        Self::TwoPoint(details)
    }
}

impl From<StaticGcpDetails> for Details {
    fn from(details: StaticGcpDetails) -> Self {
        Self::StaticGcp(details)
    }
}

impl From<DynamicGcpDetails> for Details {
    fn from(details: DynamicGcpDetails) -> Self {
        Self::DynamicGcp(details)
    }
}

impl From<InterPrismDetails> for Details {
    fn from(details: InterPrismDetails) -> Self {
        Self::InterPrism(Box::new(details))
    }
}

impl From<(JointResult, InterPrismDetails)> for Details {
    fn from((estimate, details): (JointResult, InterPrismDetails)) -> Self {
        let targets = JointTargets::ThreePrisms(details);
        Self::Joint(Box::new(JointDetails { estimate, targets }))
    }
}

impl From<(JointResult, DynamicGcpDetails)> for Details {
    fn from((estimate, details): (JointResult, DynamicGcpDetails)) -> Self {
        let targets = JointTargets::OnePrism(details);
        Self::Joint(Box::new(JointDetails { estimate, targets }))
    }
}
