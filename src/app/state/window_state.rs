//! The window's state, by its parts.
//!
//! Panes get the state to read and a list to put [`Command`]s on; [`State::handle`] carries them out between frames. A
//! part is plain data in a file of its own; the handlers of its commands are methods of [`State`], since most of them start
//! jobs or change another part too.

use std::sync::Arc;
use std::time::Duration;

use super::deployments::Deployments;
use super::dialogs::Dialogs;
use super::scene_state::SceneState;
use super::session_state::SessionState;
use super::time_state::TimeState;
use super::workspace::Workspace;
use crate::app::jobs::Jobs;
use crate::app::model::live::Live;
use crate::app::model::toasts::Toasts;
use crate::app::model::undo::Moment;
use crate::app::model::{Asked, Command, OpenDeployment, Planning, Results};
use crate::app::prepared::analyser::Analyser;
use resect_core::analysis::{Analysis, Settings};
use resect_core::progress::Progress;
use resect_report::of_run;

/// How long an answer may be late before it is dimmed: a slider that is answered at once must not flicker.
const DIM_AFTER: Duration = Duration::from_millis(80);

pub struct State {
    pub(super) jobs: Jobs<Self>,
    pub(super) analyser: Analyser,
    pub deployments: Deployments,
    pub time: TimeState,
    pub scene: SceneState,
    pub results: Results,
    pub planning: Planning,
    pub live: Live,
    pub session: SessionState,
    pub dialogs: Dialogs,
    pub workspace: Workspace,
    pub toasts: Toasts,
    /// Requests that read files for another part: kinds of paths, tables, trajectories, plans.
    pub(super) path_requests: Vec<u64>,
}

impl State {
    pub fn new(ctx: egui::Context) -> Self {
        let theme = ctx.options(|options| options.theme_preference);
        let jobs = Jobs::new(ctx, Self::failed);
        let outbox = jobs.outbox();
        let analyser = Analyser::start(move |found| {
            outbox.put(move |state: &mut Self| match found {
                Ok(answered) => state.take_analysed(answered),
                Err(number) => state.failed(number),
            });
        });
        Self {
            jobs,
            analyser,
            deployments: Deployments::default(),
            time: TimeState::default(),
            scene: SceneState::default(),
            results: Results::default(),
            planning: Planning::default(),
            live: Live::default(),
            session: SessionState::default(),
            dialogs: Dialogs::default(),
            workspace: Workspace { theme, ..Workspace::default() },
            toasts: Toasts::default(),
            path_requests: Vec::new(),
        }
    }

    /// Carries out a command.
    pub fn handle(&mut self, command: impl Into<Command>, ctx: &egui::Context) {
        let moment = Moment::now(ctx);
        match command.into() {
            Command::Deployment(command) => self.handle_deployment(command, ctx),
            Command::Time(command) => self.handle_time(command),
            Command::Scene(command) => self.handle_scene(command, ctx),
            Command::Results(command) => self.handle_results(command, ctx),
            Command::Judging(command) => self.handle_judging(command, moment),
            Command::Plan(command) => self.handle_plan(command, moment),
            Command::Live(command) => self.handle_live(command),
            Command::Session(command) => self.handle_session(command),
            Command::Dialog(command) => self.handle_dialog(command, ctx),
            Command::Workspace(command) => self.handle_workspace(command, ctx),
        }
    }

    /// What the panes show.
    pub fn active(&self) -> Option<&OpenDeployment> {
        self.deployments.active()
    }

    /// The active deployment with its newest answer, once there is one.
    pub fn analysed(&self) -> Option<(&OpenDeployment, &Arc<Analysis>)> {
        let active = self.active()?;
        Some((active, active.analysis.as_ref()?))
    }

    /// The settings of the active deployment, or what the next one starts with.
    pub fn settings(&self) -> &Settings {
        self.deployments.settings()
    }

    /// What the user is asked, if anything.
    pub fn asked(&self) -> Option<&Asked> {
        self.dialogs.asked.front().map(|waiting| &waiting.asked)
    }

    /// Whether anything is being opened, saved as a session, calibrated, studied or validated.
    pub fn is_busy(&self) -> bool {
        let analysing = self.deployments.open.iter().any(|open| open.analysing.is_some());
        let listing = self.dialogs.prompt.as_ref().is_some_and(|prompt| prompt.shown.is_reading());
        !self.deployments.opening.is_empty()
            || !self.path_requests.is_empty()
            || self.session.is_busy()
            || listing
            || analysing
            || self.results.studies.running.is_some()
            || self.results.validations.running.is_some()
            || self.planning.foreseen.is_running()
            || self.planning.better.is_running()
            || self.deployments.open.iter().any(OpenDeployment::is_making)
    }

    /// What is being calibrated for longer than this, and how far it is.
    pub fn calibrating(
        &self,
        longer_than: Duration,
    ) -> impl Iterator<Item = (&OpenDeployment, &Progress)> {
        let long = move |open: &&OpenDeployment| {
            open.analysing.is_some_and(|analysing| analysing.since.elapsed() > longer_than)
        };
        let long = self.deployments.open.iter().filter(long);
        long.filter_map(move |open| Some((open, self.analyser.progress(open.id)?)))
    }

    /// Whether the answer shown is old enough to be dimmed.
    pub fn is_stale(&self) -> bool {
        let Some(open) = self.active() else { return false };
        match open.analysing {
            Some(analysing) => !analysing.joint_follows && analysing.since.elapsed() > DIM_AFTER,
            // A calculation that failed leaves the answer of other settings.
            None => open.analysis.as_ref().is_some_and(|a| a.settings != open.settings),
        }
    }

    /// How long the answer took (ms), once there is one, and unless the picture is to be compared.
    pub fn elapsed_ms(&self) -> Option<f64> {
        let (_, analysis) = self.analysed()?;
        self.workspace
            .fixed_elapsed_ms
            .or_else(|| of_run::tells_durations().then(|| analysis.total_ms()))
    }

    /// Time of the active deployment's first measurement (s).
    pub fn start_s(&self) -> f64 {
        self.active().map_or(0.0, OpenDeployment::start_s)
    }

    /// Moves what moves by itself on to this time of the window's clock (s); gives when something will go next.
    pub fn advance(&mut self, now_s: f64) -> Option<f64> {
        if let Some(open) = self.deployments.active_mut() {
            self.time.playback.advance(&mut open.timeline, now_s);
        }
        self.make_what_is_looked_at();
        let hand_is_on = self.jobs.ctx().input(|input| input.pointer.any_down());
        self.foresee(hand_is_on);
        self.toasts.advance(now_s)
    }
}
