//! What the pane of the trajectory plots.

use serde::{Deserialize, Serialize};

use crate::app::prepared::aspects::Aspect;

/// The strips that are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct WayPlots {
    /// In the order of [`Aspect::ALL`].
    pub aspects: [bool; Aspect::ALL.len()],
    /// The errors of trajectories that were added.
    pub errors: bool,
    /// Whether errors are plotted over the way that was driven, instead of over time.
    pub by_distance: bool,
    /// Whether the errors of all trajectories have one scale: a good one beside a bad one is a line then.
    pub one_scale: bool,
}

impl Default for WayPlots {
    fn default() -> Self {
        let first = [Aspect::Height, Aspect::Heading, Aspect::PositionSigma];
        Self {
            aspects: Aspect::ALL.map(|aspect| first.contains(&aspect)),
            errors: true,
            by_distance: false,
            one_scale: false,
        }
    }
}

impl WayPlots {
    /// The errors alone: who adds trajectories came for them, and a strip each needs the height.
    pub fn only_errors(self) -> Self {
        Self { aspects: [false; Aspect::ALL.len()], errors: true, ..self }
    }

    pub fn aspects(self) -> impl Iterator<Item = Aspect> {
        Aspect::ALL.into_iter().zip(self.aspects).filter_map(|(aspect, on)| on.then_some(aspect))
    }
}
