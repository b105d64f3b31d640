//! Remedies of findings as data: the window offers them as buttons, the command line as flags.

use super::Overrides;

/// A remedy that a finding advises.
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
