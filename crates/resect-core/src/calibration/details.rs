//! Details of a calibration by method.

use super::dynamic_gcp::DynamicGcpDetails;
use super::inter_prism::InterPrismDetails;
use super::joint_failure::JointResult;
use super::static_gcp::StaticGcpDetails;
use super::two_point::TwoPointDetails;

/// Details of a joint estimate.
#[derive(Clone, Debug)]
pub struct JointDetails {
    /// The estimate, or the reason why the answer is the published one.
    pub estimate: JointResult,
    /// Minima, mirror twin and observability on the corrected readings, or with one prism the alignment of the tracks from which the
    /// estimate starts.
    pub published: Details,
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

impl<D: Into<Self>> From<(JointResult, D)> for Details {
    fn from((estimate, published): (JointResult, D)) -> Self {
        Self::Joint(Box::new(JointDetails { estimate, published: published.into() }))
    }
}

impl Details {
    /// Returns the details of method D, and of a joint estimate that starts from it.
    pub fn inter_prism(&self) -> Option<&InterPrismDetails> {
        match self {
            Self::InterPrism(details) => Some(details),
            Self::Joint(details) => details.published.inter_prism(),
            _ => None,
        }
    }

    /// Returns the root mean square of the point errors of methods A, B and C, and of the tracks of one prism (m).
    pub fn fit_rms_m(&self) -> Option<f64> {
        match self {
            Self::TwoPoint(details) => Some(details.rms_m()),
            Self::StaticGcp(details) => Some(details.rms_m),
            Self::DynamicGcp(details) => Some(details.rms_m),
            Self::InterPrism(_) => None,
            Self::Joint(details) => details.published.fit_rms_m(),
        }
    }
}
