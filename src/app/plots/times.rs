//! Time window, cursor and selection of the plots.

use crate::app::model::{OpenDeployment, TimeScale};
use crate::app::state::State;

/// Time state of the panes, in seconds since the first measurement unless noted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Times {
    /// The first measurement, in the stations' clock (s).
    pub start_s: f64,
    pub window_s: [f64; 2],
    pub cursor_s: Option<f64>,
    /// The time under the pointer, in any pane (s).
    pub hover_s: Option<f64>,
    pub selection_s: Option<[f64; 2]>,
    /// Format of times.
    pub scale: TimeScale,
}

impl Times {
    pub fn of(open: &OpenDeployment, state: &State) -> Self {
        let start_s = open.start_s();
        let since = |time_s: f64| time_s - start_s;
        let timeline = &open.timeline;
        Self {
            start_s,
            window_s: timeline.window_s.map(since),
            cursor_s: timeline.cursor_s.map(since),
            hover_s: state.time.hover_s.map(since),
            selection_s: timeline.selection_s.map(|span_s| span_s.map(since)),
            scale: TimeScale::new(state.workspace.units.time, start_s),
        }
    }
}
