//! Independent checks of an answer, by data that it does not use.

use serde::{Deserialize, Serialize};

/// Data that could have contradicted an answer, and that agrees with it. Control points that a joint estimate uses are independent of
/// its drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Witness {
    /// Points that every station measured by hand.
    ControlPoints,
    /// The inter-prism distances of the drive.
    Distances,
    /// Orientation and heights of the prisms in a reading of the rig. They check the sense of azimuths and the numbers of the
    /// stations; a biased answer would pass as well.
    Rig,
}

impl Witness {
    /// Returns true if it checks the values of an answer, and not its sense alone.
    pub fn is_independent(self) -> bool {
        self != Self::Rig
    }
}
