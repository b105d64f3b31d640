//! One of the deployments that are open: its data, its settings, its newest answer.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Instant;

use super::{Judging, Made, Timeline};
use crate::app::prepared::analyser::Answered;
use crate::app::prepared::beside::RunBeside;
use crate::app::prepared::channels::Sources;
use crate::app::prepared::way::Way;
use crate::app::prepared::{Clouds, PreparedPlots};
use resect_core::analysis::{Analysis, Settings};
use resect_core::deployment::{Deployment, FindingIdentity};
use resect_io::source::Source;
use resect_report::summary::ResultSummary;

/// Prisms that were seen together no longer ago than this are seen now (s).
const LATELY_S: f64 = 3.0;

pub struct OpenDeployment {
    /// Tells it from every other that was ever opened.
    pub id: u64,
    pub deployment: Arc<Deployment>,
    /// The same with more readings, of which an answer is awaited.
    pub more: Option<Arc<Deployment>>,
    /// Where the deployment can be read again.
    pub source: Option<Source>,
    /// The longest range of each station (m); found once, because the window asks in every frame.
    pub longest_range_m: [f64; 3],
    pub settings: Settings,
    /// The newest answer; older than the settings while it is stale.
    pub analysis: Option<Arc<Analysis>>,
    /// The answer as plain data, if there is one.
    pub summary: Option<Arc<ResultSummary>>,
    /// The plots of the newest answer.
    pub plots: Arc<PreparedPlots>,
    /// The readings and tracks of the newest answer, for the scene.
    pub clouds: Clouds,
    /// Counts the answers that were taken in: changes with what is shown.
    pub analysis_run: u64,
    pub timeline: Timeline,
    /// The vehicle's way by the newest answer, made while it is looked at.
    pub way: Made<Way>,
    /// The ways of the other open runs in its frame, made while they are looked at.
    pub beside: Made<Vec<RunBeside>>,
    /// Trajectories of other systems that are held against it.
    pub judging: Judging,
    /// Opened by the program itself, and never touched: gives way to the first that the user opens.
    pub placeholder: bool,
    /// Findings that the user has seen.
    pub told: BTreeSet<FindingIdentity>,
    /// Whether any answer was there to the end, and not the paper's alone, ahead of a joint estimate.
    pub answered: bool,
    /// The newest request for an answer, while it is awaited.
    pub analysing: Option<Analysing>,
}

/// The newest request for an answer.
#[derive(Clone, Copy)]
pub struct Analysing {
    pub number: u64,
    /// Since when the answer shown is that of other settings.
    pub since: Instant,
    /// The paper's answer is shown meanwhile.
    pub joint_follows: bool,
}

impl OpenDeployment {
    pub fn new(
        id: u64,
        deployment: Arc<Deployment>,
        source: Option<Source>,
        settings: Settings,
    ) -> Self {
        let longest_range_m = longest_range_m(&deployment);
        let timeline = Timeline::new(&deployment);
        Self {
            id,
            deployment,
            more: None,
            source,
            longest_range_m,
            settings,
            analysis: None,
            summary: None,
            plots: Arc::default(),
            clouds: Clouds::default(),
            analysis_run: 0,
            timeline,
            way: Made::default(),
            beside: Made::default(),
            judging: Judging::default(),
            placeholder: false,
            told: BTreeSet::new(),
            answered: false,
            analysing: None,
        }
    }

    /// Whether anything is being made of its answer for who looks at it.
    pub fn is_making(&self) -> bool {
        self.way.is_running() || self.beside.is_running() || self.judging.judgement.is_running()
    }

    /// The deployment under the name that tells it from the others; a copy only where that is another than its own.
    pub fn named(&self, name: String) -> Arc<Deployment> {
        if self.deployment.name == name {
            return Arc::clone(&self.deployment);
        }
        Arc::new(Deployment { name, ..Deployment::clone(&self.deployment) })
    }

    /// Takes in the same deployment, read again with other files; the old answer stays until the new one is there.
    pub fn replace(&mut self, deployment: Arc<Deployment>, source: Source) {
        self.longest_range_m = longest_range_m(&deployment);
        let old = std::mem::replace(&mut self.timeline, Timeline::new(&deployment));
        if old.whole_s == self.timeline.whole_s {
            self.timeline = old;
        }
        let readings = |of: &Deployment| of.tracks.each_ref().map(|track| track.measurements.len());
        if readings(&self.deployment) != readings(&deployment) {
            // The old answer counts readings that are others now.
            (self.analysis, self.summary) = (None, None);
            self.answered = false;
            (self.plots, self.clouds) = (Arc::default(), Clouds::default());
            self.timeline.picked = None;
        }
        self.deployment = deployment;
        self.more = None;
        self.source = Some(source);
        self.placeholder = false;
    }

    /// Takes in what the answer that comes with it is of: the same deployment with more readings.
    fn grow(&mut self, deployment: Arc<Deployment>) {
        self.longest_range_m = longest_range_m(&deployment);
        self.timeline.grow(&deployment);
        self.deployment = deployment;
    }

    /// Returns the data that channels are read from.
    pub fn sources(&self) -> Sources<'_> {
        Sources { plots: &self.plots, way: self.way.newest.as_deref(), start_s: self.start_s() }
    }

    /// Time of the first measurement (s): what the plots count from.
    pub fn start_s(&self) -> f64 {
        self.deployment.start_s().unwrap_or(0.0)
    }

    /// Whether the paper's answer is shown until the joint estimate is there.
    pub fn joint_follows(&self) -> bool {
        self.analysing.is_some_and(|analysing| analysing.joint_follows)
    }

    /// Takes in an answer, unless a newer one is on its way; tells whether it did.
    pub fn take(&mut self, answered: Answered) -> bool {
        let Some(analysing) = self.analysing.filter(|newest| newest.number == answered.number)
        else {
            return false;
        };
        let Answered { analysis, plots, clouds, joint_follows, .. } = answered;
        let follows =
            self.more.is_some() && self.timeline.cursor_s.is_some_and(|at_s| at_s >= self.now_s());
        if let Some(more) = self.more.take() {
            self.grow(more);
        }
        self.analysing = joint_follows.then_some(Analysing { joint_follows, ..analysing });
        self.answered |= !joint_follows;
        if self.timeline.cursor_s.is_none() {
            // So that the rig is seen before anything is clicked.
            let time_s = &analysis.pipeline.triplets.time_s;
            self.timeline.cursor_s = time_s.get(time_s.len() / 2).copied();
        }
        self.summary = analysis
            .answer
            .as_ref()
            .ok()
            .map(|answer| Arc::new(ResultSummary::of(&self.deployment, &analysis, answer)));
        self.analysis = Some(analysis);
        self.plots = plots;
        self.clouds = clouds;
        self.analysis_run += 1;
        if follows {
            self.timeline.move_cursor(self.now_s());
        }
        true
    }

    /// Gives the newest instant (s): that of the last triplet, or of the last reading where the prisms are not seen together any more. A
    /// cursor that is there goes along while the deployment grows.
    pub fn now_s(&self) -> f64 {
        let end_s = self.timeline.whole_s[1];
        let analysis = self.analysis.as_ref();
        let last_s = analysis.and_then(|analysis| analysis.triplets().time_s.last().copied());
        last_s.filter(|last_s| end_s - last_s < LATELY_S).unwrap_or(end_s)
    }
}

fn longest_range_m(deployment: &Deployment) -> [f64; 3] {
    deployment
        .tracks
        .each_ref()
        .map(|track| track.measurements.iter().map(|m| m.range_m).fold(0.0, f64::max))
}
