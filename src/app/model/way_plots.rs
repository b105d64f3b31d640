//! What the pane of the trajectory plots.

use serde::{Deserialize, Serialize};

use crate::app::prepared::way::Aspect;

/// The strips that are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct WayPlots {
    /// In the order of [`Aspect::ALL`].
    pub aspects: [bool; Aspect::ALL.len()],
    /// The errors of trajectories that were added.
    pub errors: bool,
}

impl Default for WayPlots {
    fn default() -> Self {
        let first = [Aspect::Height, Aspect::Heading, Aspect::PositionSigma];
        Self { aspects: Aspect::ALL.map(|aspect| first.contains(&aspect)), errors: true }
    }
}

impl WayPlots {
    /// The errors alone: who adds trajectories came for them, and a strip each needs the height.
    pub fn only_errors() -> Self {
        Self { aspects: [false; Aspect::ALL.len()], errors: true }
    }

    pub fn aspects(self) -> impl Iterator<Item = Aspect> {
        Aspect::ALL.into_iter().zip(self.aspects).filter_map(|(aspect, on)| on.then_some(aspect))
    }
}
