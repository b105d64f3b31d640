//! Reasons why two trajectories give no extrinsic calibration.

use crate::estimates::Unjudged;

/// Reason why two trajectories give no extrinsic calibration.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoExtrinsics {
    #[error("{a} has no orientations, and {b} has; give {b} first, as body a")]
    Exchanged { a: String, b: String },
    #[error(
        "neither {a} nor {b} has orientations; the pose of one in the other needs the orientations of one"
    )]
    NoOrientations { a: String, b: String },
    #[error("{0} and {1} are the same trajectory; give those of two bodies")]
    Same(String, String),
    #[error(transparent)]
    Unfit(#[from] Unjudged),
}
