//! Playback, the time under the pointer, and the channel plots.
//!
//! The time cursor and the selection belong to each deployment: `OpenDeployment::timeline`.

use crate::app::model::{ChannelPlots, Playback};

#[derive(Default)]
pub struct TimeState {
    pub playback: Playback,
    /// Time under the pointer in the last frame, in any pane (s, the stations' clock).
    pub hover_s: Option<f64>,
    /// Plots of the channels pane.
    pub plots: ChannelPlots,
}
