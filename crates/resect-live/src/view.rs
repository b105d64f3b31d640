//! State of a live deployment at an instant, as plain data for the window and the command.

use resect_core::network::PerStation;
use std::sync::Arc;

use super::coach::Curve;
use super::judged::Judged;
use super::recorder::Recorded;
use super::status::StationStatus;
use super::warnings::Warning;
use resect_tools::planning::NextMove;

/// State of the connection.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Link {
    #[default]
    Connecting,
    /// Connected to a source of this name.
    Connected(String),
    Lost {
        why: String,
        again_in_s: f64,
    },
    /// The source has ended.
    Ended,
}

/// Items left out for one reason, with a description of the first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Left {
    pub what: &'static str,
    pub count: u64,
    pub first: String,
}

/// A live deployment at an instant.
#[derive(Clone, Debug, Default)]
pub struct View {
    /// Time by the source's clock (s since 1970); `None` before the first message.
    pub now_s: Option<f64>,
    /// Duration since the first reading, by the stamps (s).
    pub driven_s: f64,
    pub link: Link,
    pub connections: u64,
    pub messages: u64,
    pub stations: PerStation<StationStatus>,
    /// Readings with the stamp of an earlier one, and late readings, which were sorted in by their stamps.
    pub repeated: usize,
    pub late: usize,
    /// Records that are no valid readings.
    pub dropped: usize,
    pub left_out: Vec<Left>,
    pub warnings: Vec<Warning>,
    /// Newest answers by the paper's method and with the chosen settings.
    pub first: Option<Arc<Judged>>,
    pub answer: Option<Arc<Judged>>,
    /// Age of the newest reading in `answer`, by the stamps (s).
    pub answer_age_s: Option<f64>,
    pub target_m: f64,
    pub enough: bool,
    pub sentence: String,
    /// Next manoeuvres, the largest gain per second first.
    pub moves: Vec<NextMove>,
    /// σ at the far end of the track over the drive, by the paper's method and with the chosen settings.
    pub curves: [Curve; 2],
    pub recorded: Option<Recorded>,
}

impl View {
    /// Returns the answer to show: that with the chosen settings, or the paper's until there is one.
    pub fn shown(&self) -> Option<&Arc<Judged>> {
        self.answer.as_ref().or(self.first.as_ref())
    }

    pub fn readings(&self) -> u64 {
        self.stations.iter().map(|station| station.readings).sum()
    }
}
