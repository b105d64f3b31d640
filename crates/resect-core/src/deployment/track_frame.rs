//! The frames that the tracks of a deployment are in.

use serde::{Deserialize, Serialize};

/// The frames that a deployment's tracks are in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TrackFrame {
    /// Each in its station's own, as measured; answers map those of stations 2 and 3 to that of station 1.
    #[default]
    Own,
    /// All in one, into which somebody turned them before they were written, in a way that is not known. Answers from
    /// the tracks (methods C and D) map what is left; answers from control points (A and B) are about the stations' own
    /// frames, and the two cannot be compared.
    Common,
}
