//! Remedies of findings as data: the window offers them as buttons, the command line as flags.

use super::Overrides;

/// A remedy that a finding advises.
#[derive(Clone, Debug, PartialEq)]
pub enum Remedy {
    /// Uses the joint estimate, which models the error.
    JointEstimate,
    /// Uses the paper's method for this data.
    PublishedMethod,
    /// Starts from the closed form instead of the search.
    ClosedFormPrior,
    /// Rotates points about the vertical only.
    LevelAlignment,
    /// Relaxes the pipeline's filters.
    RelaxFilters,
    /// Adds a file that describes the rig.
    GiveRig,
    GiveControlPoints,
    /// Checks the data that was read for errors.
    Corrections,
    /// Reads the data with these overrides of its files.
    ReadWith(Box<Overrides>),
    /// Shows the measurements of a span of time (s, in the stations' clock).
    ShowTimes([f64; 2]),
    /// Shows a control point, by its file and marker.
    ShowPoint {
        file: String,
        marker: i64,
    },
}
