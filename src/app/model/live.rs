//! The live deployment of the window: form and session.

use std::path::PathBuf;
use std::sync::Arc;

use resect_live::{Closing, Pace, Session, View, Wanted};

/// Form of a live connection.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveForm {
    /// Address of a stream.
    pub address: String,
    /// Deployment to replay instead, and `speed`, how much faster than it was driven.
    pub replay: Option<PathBuf>,
    pub speed: f64,
    /// Folder or file with prior information: rig, control points.
    pub known: Option<PathBuf>,
    /// Topics or instruments of stations 1, 2, …, separated by commas; empty if the messages name their station.
    pub stations: String,
    /// Path of the recording; `None` for an automatic name, and for a replay, which is on disk already.
    pub record: Option<PathBuf>,
    /// Target of σ at the far end of the track (mm).
    pub target_mm: f64,
}

impl Default for LiveForm {
    fn default() -> Self {
        Self {
            address: "ws://localhost:8765".to_owned(),
            replay: None,
            speed: 10.0,
            known: None,
            stations: String::new(),
            record: None,
            target_mm: 2.0,
        }
    }
}

/// Commands of a live deployment.
#[derive(Clone, Debug, PartialEq)]
pub enum LiveCommand {
    /// Shows the form.
    Show,
    Edit(LiveForm),
    ChooseReplay,
    ChooseKnown,
    ChooseRecord,
    Connect,
    /// Stops the session; the deployment stays open with the readings received so far.
    Stop,
}

/// The live deployment, or the last one.
#[derive(Default)]
pub struct Live {
    pub form: LiveForm,
    pub session: Option<Session>,
    /// Parameters of the session.
    pub wanted: Option<Wanted>,
    /// Limits how often the growing data is calibrated.
    pub pace: Pace,
    /// True while a session is started or stopped in the background.
    pub is_changing: bool,
    /// True while a session is stopped; its recording is incomplete until then.
    pub is_ending: bool,
    /// The last view of the session, kept after its end.
    pub view: Option<Arc<View>>,
    /// The ended session, until all of its readings have a result.
    pub closing: Option<Closing>,
    /// Id of the open deployment that grows.
    pub id: Option<u64>,
    /// True if that deployment was closed in the meantime.
    pub was_closed: bool,
    /// Reason why the session did not start, or the error of its recording.
    pub trouble: Option<String>,
}

impl Live {
    /// Returns true while a session runs.
    pub fn is_running(&self) -> bool {
        self.session.is_some()
    }
}
