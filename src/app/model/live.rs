//! The live deployment of the window: what is asked for, and what listens.

use std::path::PathBuf;
use std::sync::Arc;

use resect_live::{Closing, Pace, Session, View, Wanted};

/// What the user fills in before it is connected.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveForm {
    /// Address of a stream.
    pub address: String,
    /// A deployment to replay instead, and how much faster than it was driven.
    pub replay: Option<PathBuf>,
    pub speed: f64,
    /// Folder or file with what is known beforehand: rig, control points.
    pub known: Option<PathBuf>,
    /// Topics, or instruments, of stations 1, 2, 3, with commas between; nothing where messages name their station.
    pub stations: String,
    pub records: bool,
    /// Where to; a name is made up where nobody chose one.
    pub record: Option<PathBuf>,
    /// What σ has to come down to at the far end of the track (mm).
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
            records: true,
            record: None,
            target_mm: 2.0,
        }
    }
}

/// What is done about a live deployment.
#[derive(Clone, Debug, PartialEq)]
pub enum LiveCommand {
    /// Shows where it is filled in.
    Show,
    Edit(LiveForm),
    ChooseReplay,
    ChooseKnown,
    ChooseRecord,
    Connect,
    /// Ends it; the deployment stays open as it is by then.
    Stop,
}

/// The live deployment, if there is one, and the last.
#[derive(Default)]
pub struct Live {
    pub form: LiveForm,
    pub session: Option<Session>,
    /// What the session was begun with.
    pub wanted: Option<Wanted>,
    /// How often what grows is answered from.
    pub pace: Pace,
    /// Whether a session is being begun or ended beside the window.
    pub is_changing: bool,
    /// Whether one is being ended, whose recording is not whole before that is done.
    pub is_ending: bool,
    /// What was told last, also after the end.
    pub view: Option<Arc<View>>,
    /// What has ended, until all of its readings have their answer.
    pub closing: Option<Closing>,
    /// The open deployment that grows, by its id.
    pub id: Option<u64>,
    /// Whether that was closed meanwhile.
    pub was_closed: bool,
    /// Why it was not begun, or how its recording ended.
    pub trouble: Option<String>,
}

impl Live {
    /// Whether something is listened to.
    pub fn is_running(&self) -> bool {
        self.session.is_some()
    }
}
