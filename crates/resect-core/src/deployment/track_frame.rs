//! The frames that the tracks of a deployment are in.

use serde::{Deserialize, Serialize};

/// The frames that a deployment's tracks are in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TrackFrame {
    /// Each station's own frame, as measured; answers transform those of the others into that of station 1.
    #[default]
    Own,
    /// One common frame, into which an unknown transform turned the tracks before they were written. Answers from the tracks
    /// (methods C and D) are the remaining transforms. Answers from control points (A and B) are about the stations' own
    /// frames, so the two cannot be compared.
    Common,
}
