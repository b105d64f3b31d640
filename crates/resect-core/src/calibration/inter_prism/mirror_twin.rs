//! The mirror twin of an answer.

use super::basin::Basin;

/// Data that excludes the mirror twin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResolvedBy {
    /// The heights of the prisms on the vehicle.
    Rig,
    ControlPoints,
    /// Cost: pitch and roll of the vehicle made the twin fit worse.
    Cost,
    /// The likelihood of all readings, by joint estimates of the answer and of the twin.
    Likelihood,
    /// No data: the answer may be the twin.
    Nothing,
}

impl ResolvedBy {
    pub fn name(self) -> Option<&'static str> {
        match self {
            Self::Rig => Some("rig"),
            Self::ControlPoints => Some("control-points"),
            Self::Cost => Some("cost"),
            Self::Likelihood => Some("likelihood"),
            Self::Nothing => None,
        }
    }
}

/// Second solution of method D on level ground, and the data that excludes it.
#[derive(Clone, Debug, PartialEq)]
pub struct Mirror {
    /// The twin; `None` if it is not a separate minimum.
    pub twin: Option<Basin>,
    /// Cost of the twin over that of the answer.
    pub cost_ratio: Option<f64>,
    pub resolved_by: ResolvedBy,
}
