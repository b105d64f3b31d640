//! An open deployment: its data, settings and newest result.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Instant;

use super::{BackgroundValue, Judging, Timeline};
use crate::app::prepared::analyser::Answered;
use crate::app::prepared::beside::RunBeside;
use crate::app::prepared::channels::Sources;
use crate::app::prepared::way::Way;
use crate::app::prepared::{Clouds, PreparedPlots};
use resect_core::analysis::{Analysis, Settings};
use resect_core::deployment::{Deployment, FindingIdentity};
use resect_core::network::PerStation;
use resect_io::source::Source;
use resect_report::summary::ResultSummary;

/// Largest age of the last triplet (s) at which the prisms still count as visible.
const LATELY_S: f64 = 3.0;

pub struct OpenDeployment {
    /// Unique id among all deployments that were ever opened.
    pub id: u64,
    pub deployment: Arc<Deployment>,
    /// The deployment with more readings, whose result is awaited.
    pub more: Option<Arc<Deployment>>,
    /// The source from which the deployment can be read again.
    pub source: Option<Source>,
    /// Longest range of each station (m), cached because every frame needs it.
    pub longest_range_m: PerStation<f64>,
    pub settings: Settings,
    /// The newest result; older than the settings while it is stale.
    pub analysis: Option<Arc<Analysis>>,
    /// Summary of the result, if there is one.
    pub summary: Option<Arc<ResultSummary>>,
    /// The plots of the newest result.
    pub plots: Arc<PreparedPlots>,
    /// The readings and tracks of the newest result, for the scene.
    pub clouds: Clouds,
    /// Number of results received; changes with the displayed result.
    pub analysis_run: u64,
    pub timeline: Timeline,
    /// The vehicle's trajectory by the newest result, computed while it is visible.
    pub way: BackgroundValue<Way>,
    /// Trajectories of the other open runs in this deployment's frame, computed while they are visible.
    pub beside: BackgroundValue<Vec<RunBeside>>,
    /// Estimated trajectories, evaluated against the deployment.
    pub judging: Judging,
    /// True if the program opened it and nobody changed it; the first deployment of the user replaces it.
    pub placeholder: bool,
    /// Findings that were shown to the user.
    pub told: BTreeSet<FindingIdentity>,
    /// True once a final result was received, not only the paper's method ahead of a joint estimate.
    pub answered: bool,
    /// The newest request for a result, while it is awaited.
    pub analysing: Option<Analysing>,
}

/// The newest request for a result.
#[derive(Clone, Copy)]
pub struct Analysing {
    pub number: u64,
    /// Time since which the displayed result has other settings.
    pub since: Instant,
    /// True while the result of the paper's method is shown and the joint estimate is awaited.
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
        let judging = Judging::against(&deployment);
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
            way: BackgroundValue::default(),
            beside: BackgroundValue::default(),
            judging,
            placeholder: false,
            told: BTreeSet::new(),
            answered: false,
            analysing: None,
        }
    }

    /// Returns true while anything is computed from its result for display.
    pub fn is_making(&self) -> bool {
        self.way.is_running()
            || self.beside.is_running()
            || self.judging.judgement.is_running()
            || self.judging.extrinsics.is_running()
    }

    /// Returns the deployment under its unique name; copies it only if that differs from its own.
    pub fn named(&self, name: String) -> Arc<Deployment> {
        if self.deployment.name == name {
            return Arc::clone(&self.deployment);
        }
        Arc::new(Deployment { name, ..Deployment::clone(&self.deployment) })
    }

    /// Replaces the data by that of another reading with other files; the old result stays until the new one is computed.
    pub fn replace(&mut self, deployment: Arc<Deployment>, source: Source) {
        self.longest_range_m = longest_range_m(&deployment);
        let old = std::mem::replace(&mut self.timeline, Timeline::new(&deployment));
        if old.whole_s == self.timeline.whole_s {
            self.timeline = old;
        }
        let readings = |of: &Deployment| of.tracks.map(|track| track.measurements.len());
        if readings(&self.deployment) != readings(&deployment) {
            // Indices of readings in the old result are no longer valid.
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

    /// Extends the deployment to the readings of the result that was just received.
    fn grow(&mut self, deployment: Arc<Deployment>) {
        self.longest_range_m = longest_range_m(&deployment);
        self.timeline.grow(&deployment);
        self.deployment = deployment;
    }

    /// Returns the data of the channels.
    pub fn sources(&self) -> Sources<'_> {
        Sources { plots: &self.plots, way: self.way.newest.as_deref(), start_s: self.start_s() }
    }

    /// Returns the time of the first measurement (s), from which the plots count.
    pub fn start_s(&self) -> f64 {
        self.deployment.start_s().unwrap_or(0.0)
    }

    /// Returns true while the result of the paper's method is shown and the joint estimate is awaited.
    pub fn joint_follows(&self) -> bool {
        self.analysing.is_some_and(|analysing| analysing.joint_follows)
    }

    /// Stores a result, unless a newer one is awaited; returns true if it was stored.
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
            // Shows the rig before the user clicks anything.
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

    /// Returns the newest time (s): that of the last triplet, or of the last reading if the last triplet is too old.
    ///
    /// While the deployment grows, a cursor at this time moves with it.
    pub fn now_s(&self) -> f64 {
        let end_s = self.timeline.whole_s[1];
        let analysis = self.analysis.as_ref();
        let last_s = analysis.and_then(|analysis| analysis.triplets().time_s.last().copied());
        last_s.filter(|last_s| end_s - last_s < LATELY_S).unwrap_or(end_s)
    }
}

fn longest_range_m(deployment: &Deployment) -> PerStation<f64> {
    deployment.tracks.map(|track| track.measurements.iter().map(|m| m.range_m).fold(0.0, f64::max))
}
