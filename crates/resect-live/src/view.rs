//! All that is told of a live deployment at an instant, as plain data: what the window draws and the command prints.

use std::sync::Arc;

use super::coach::Curve;
use super::judged::Judged;
use super::recorder::Recorded;
use super::status::StationStatus;
use super::warnings::Warning;
use resect_core::planning::NextMove;

/// How the connection is.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Link {
    #[default]
    Connecting,
    /// To a source of this name.
    Connected(String),
    Lost {
        why: String,
        again_in_s: f64,
    },
    /// Everything was said.
    Ended,
}

/// What was left out, by kind, with the first of it in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Left {
    pub what: &'static str,
    pub count: u64,
    pub first: String,
}

/// A live deployment at an instant.
#[derive(Clone, Debug, Default)]
pub struct View {
    /// By the source's clock (s since 1970); `None` before the first message.
    pub now_s: Option<f64>,
    /// Since the first reading, by the stamps (s).
    pub driven_s: f64,
    pub link: Link,
    pub connections: u64,
    pub messages: u64,
    pub stations: [StationStatus; 3],
    /// Readings with the stamp of another that was there before; those that came late were put in their place.
    pub repeated: usize,
    pub late: usize,
    /// Records that cannot be readings.
    pub dropped: usize,
    pub left_out: Vec<Left>,
    pub warnings: Vec<Warning>,
    /// The newest paper's answer, and the newest answer of the settings.
    pub first: Option<Arc<Judged>>,
    pub answer: Option<Arc<Judged>>,
    /// How long ago by the stamps the newest reading was measured that the answer of the settings knows of (s).
    pub answer_age_s: Option<f64>,
    pub target_m: f64,
    pub enough: bool,
    pub sentence: String,
    /// What to drive next, what gains most in a second first.
    pub moves: Vec<NextMove>,
    /// σ at the far end of the track over the drive, by the paper's answer and by that of the settings.
    pub curves: [Curve; 2],
    pub recorded: Option<Recorded>,
}

impl View {
    /// The answer that is shown: that of the settings, or before there is one the paper's.
    pub fn shown(&self) -> Option<&Arc<Judged>> {
        self.answer.as_ref().or(self.first.as_ref())
    }

    pub fn readings(&self) -> u64 {
        self.stations.iter().map(|station| station.readings).sum()
    }
}
