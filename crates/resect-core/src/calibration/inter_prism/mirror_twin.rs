//! The mirror twin of an answer.

use super::basin::Basin;

/// The witness that excludes the mirror twin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResolvedBy {
    /// The heights of the prisms on the vehicle.
    Rig,
    ControlPoints,
    /// Pitch and roll of the vehicle made the twin fit worse.
    Cost,
    /// None: the answer may be the twin.
    Nothing,
}

impl ResolvedBy {
    pub fn name(self) -> Option<&'static str> {
        match self {
            Self::Rig => Some("rig"),
            Self::ControlPoints => Some("control-points"),
            Self::Cost => Some("cost"),
            Self::Nothing => None,
        }
    }
}

/// The second solution of method D on level ground, and the witness that excludes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// The twin, where it is a minimum of its own.
    pub twin: Option<Basin>,
    /// Cost of the twin over the cost of the answer.
    pub cost_ratio: Option<f64>,
    pub resolved_by: ResolvedBy,
}
