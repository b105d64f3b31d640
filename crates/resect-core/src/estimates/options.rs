//! Options of a comparison with the ground truth: alignment, time offset and body.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// How an estimate is brought together with the ground truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Options {
    pub alignment: Alignment,
    /// What is added to the estimate's times (s); found if `None`.
    pub time_offset_s: Option<f64>,
    pub body: Body,
}

impl Default for Options {
    fn default() -> Self {
        Self { alignment: Alignment::Rigid, time_offset_s: None, body: Body::Found }
    }
}

/// What an estimate's frame may be turned by, moved by and stretched by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Alignment {
    /// Nothing: the estimate is in station 1's frame.
    None,
    /// A rotation and a translation (evo's `--align`).
    Rigid,
    /// A scale too, for one camera alone (evo's `--align --correct_scale`).
    Similarity,
}

impl Alignment {
    /// What the frame is turned, moved and stretched by, in words: "turn and shift".
    pub fn in_words(self) -> &'static str {
        match self {
            Self::None => "nothing",
            Self::Rigid => "turn and shift",
            Self::Similarity => "scale too",
        }
    }
}

/// Where the estimate's body is in the vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Body {
    /// Nobody knows: the lever arm is found, and its rotation where the estimate has orientations.
    Found,
    /// It is the vehicle's frame, as evo takes it to be.
    Same,
    /// The lever arm is known: the body's origin in the vehicle's frame, or in the body's the one prism (m).
    Lever(Vector3<f64>),
}
