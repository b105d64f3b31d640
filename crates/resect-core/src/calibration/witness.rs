//! What checked an answer, apart from the data that it was made from.

use serde::{Deserialize, Serialize};

/// Something that an answer did not use, that could have contradicted it, and that did not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Witness {
    /// Points that every station measured by hand.
    ControlPoints,
    /// The inter-prism distances of the drive.
    Distances,
    /// Which way round and how high the prisms lie in a reading of the rig: it tells sense and numbers of the stations, but a
    /// biased answer would have passed as well.
    Rig,
}

impl Witness {
    /// Whether it checks the numbers of an answer, not its sense alone.
    pub fn is_independent(self) -> bool {
        self != Self::Rig
    }
}
