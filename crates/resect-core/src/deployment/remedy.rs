//! What can be done about a finding, as data: the window offers it as a button, the command line as its flag.

use super::Overrides;

/// Something that a finding advises.
#[derive(Clone, Debug, PartialEq)]
pub enum Remedy {
    /// Taking the joint estimate, which allows for what is wrong.
    JointEstimate,
    /// Taking the paper's method for this data.
    PublishedMethod,
    /// Starting from the closed form instead of the search.
    ClosedFormPrior,
    /// Turning points about the vertical only.
    LevelAlignment,
    /// Letting the pipeline keep more.
    RelaxFilters,
    /// Naming a file that describes the rig.
    GiveRig,
    GiveControlPoints,
    /// Looking through what was read for what is wrong.
    PutRight,
    /// Reading the data with this said over its files.
    ReadWith(Box<Overrides>),
    /// Looking at what was measured from one time to another (s, in the stations' clock).
    ShowTimes([f64; 2]),
    /// Looking at a control point, by its file and marker.
    ShowPoint {
        file: String,
        marker: i64,
    },
}

impl Remedy {
    /// The flag that does it; `None` where no flag does, and the finding itself says what to change.
    pub fn flag(&self) -> Option<&'static str> {
        match self {
            Self::JointEstimate => Some("--method joint"),
            Self::ClosedFormPrior => Some("--prior closed-form"),
            Self::LevelAlignment => Some("--alignment level"),
            Self::GiveRig => Some("--rig"),
            Self::GiveControlPoints => Some("--gcp"),
            Self::PublishedMethod
            | Self::RelaxFilters
            | Self::PutRight
            | Self::ReadWith(_)
            | Self::ShowTimes(_)
            | Self::ShowPoint { .. } => None,
        }
    }
}
