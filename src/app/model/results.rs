//! Results of the session: runs, pinned results for comparison, studies and validations.

use std::sync::Arc;
use std::time::Instant;

use super::studies::Studies;
use super::validations::Validations;
use crate::app::prepared::PreparedPlots;
use resect_core::analysis::Settings;
use resect_report::summary::ResultSummary;

/// A pinned result, with which later results are compared.
#[derive(Clone, Debug)]
pub struct Pin {
    pub id: u64,
    pub name: String,
    pub summary: Arc<ResultSummary>,
    /// True if its residuals are drawn behind the present ones.
    pub shown: bool,
    /// The residuals of the pinned result; `None` until they are computed, or when its deployment is not open.
    pub plots: Option<Arc<PreparedPlots>>,
    /// True while its residuals are computed.
    pub drawing: bool,
}

/// Result of one change of the settings.
#[derive(Clone, Debug)]
pub struct Run {
    pub id: u64,
    /// Id of the open deployment.
    pub deployment: u64,
    pub at: Instant,
    /// The result, or the reason for its absence.
    pub result: Result<Arc<ResultSummary>, String>,
    pub settings: Settings,
    /// Undo step of the run; only the last run of a drag is kept.
    pub step: u64,
}

#[derive(Default)]
pub struct Results {
    /// Runs of all deployments, the newest last.
    pub runs: Vec<Run>,
    pub pins: Vec<Pin>,
    pub studies: Studies,
    pub validations: Validations,
    newest_id: u64,
}

impl Results {
    pub fn run(&self, id: u64) -> Option<&Run> {
        self.runs.iter().find(|run| run.id == id)
    }

    pub fn next_id(&mut self) -> u64 {
        self.newest_id += 1;
        self.newest_id
    }

    /// Pins a result under a unique name, unless it is pinned already; returns its id.
    pub fn pin(&mut self, summary: Arc<ResultSummary>, plots: Option<Arc<PreparedPlots>>) -> u64 {
        if let Some(known) = self.pins.iter().find(|pin| pin.summary == summary) {
            return known.id;
        }
        let id = self.next_id();
        let taken = |name: &str| self.pins.iter().any(|pin| pin.name == name);
        // A to D are the methods, P to Z the sets of control points.
        let letters = ('E'..='O').map(String::from).find(|name| !taken(name));
        let name = letters.unwrap_or_else(|| id.to_string());
        self.pins.push(Pin { id, name, summary, shown: true, plots, drawing: false });
        id
    }
}
