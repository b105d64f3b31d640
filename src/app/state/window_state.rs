//! The window's state, by component.
//!
//! Panes read the state and add [`Command`]s to a list; [`State::handle`] executes them between frames. Each component is
//! plain data in its own file. The handlers of its commands are methods of [`State`], since most of them start jobs or
//! change other components.

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
use resect_core::network::{Pair, Prism, USUAL_STATIONS};
use resect_core::progress::Progress;
use resect_report::of_run;

/// Age of a pending request at which the result is dimmed; a slider with immediate results must not flicker.
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
    /// Requests that read files for another component: kinds of paths, tables, trajectories, plans.
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

    /// Executes a command.
    pub fn handle(&mut self, command: impl Into<Command>, ctx: &egui::Context) {
        let moment = Moment::now(ctx);
        match command.into() {
            Command::Deployment(command) => self.handle_deployment(command, ctx),
            Command::Time(command) => self.handle_time(command),
            Command::Scene(command) => self.handle_scene(command),
            Command::Results(command) => self.handle_results(command, ctx),
            Command::Judging(command) => self.handle_judging(command, moment),
            Command::Plan(command) => self.handle_plan(command, moment),
            Command::Live(command) => self.handle_live(command),
            Command::Session(command) => self.handle_session(command),
            Command::Dialog(command) => self.handle_dialog(command, ctx),
            Command::Workspace(command) => self.handle_workspace(command, ctx),
        }
    }

    /// Returns the active deployment.
    pub fn active(&self) -> Option<&OpenDeployment> {
        self.deployments.active()
    }

    /// Returns the active deployment with its newest result; `None` without a result.
    pub fn analysed(&self) -> Option<(&OpenDeployment, &Arc<Analysis>)> {
        let active = self.active()?;
        Some((active, active.analysis.as_ref()?))
    }

    /// Returns the number of stations of the active deployment.
    pub fn stations(&self) -> usize {
        self.active().map_or(USUAL_STATIONS, |open| open.deployment.tracks.len())
    }

    /// Returns the number of prisms that the stations of the active deployment follow.
    pub fn prisms(&self) -> usize {
        let followed = self.analysed().map(|(_, analysis)| &analysis.offer.followed);
        followed.map_or(USUAL_STATIONS, Prism::count)
    }

    /// Returns the number of pairs whose distances are compared: of prisms, or of stations that follow one.
    pub fn pairs(&self) -> usize {
        Pair::count(if self.prisms() == 1 { self.stations() } else { self.prisms() })
    }

    /// Returns the stations of the active deployment that the scene and the plots show.
    pub fn visible_stations(&self) -> impl Iterator<Item = usize> {
        let visible = self.scene.visibility.stations;
        (0..self.stations()).filter(move |station| visible[*station])
    }

    /// Returns the settings of the active deployment, or those of the next one.
    pub fn settings(&self) -> &Settings {
        self.deployments.settings()
    }

    /// Returns the current question to the user.
    pub fn asked(&self) -> Option<&Asked> {
        self.dialogs.asked.front().map(|waiting| &waiting.asked)
    }

    /// Returns true while anything is opened, saved as a session, calibrated, studied or validated.
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

    /// Returns the deployments whose calibration takes longer than this, each with its progress.
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

    /// Returns true if the displayed result is stale enough to be dimmed.
    pub fn is_stale(&self) -> bool {
        let Some(open) = self.active() else { return false };
        match open.analysing {
            Some(analysing) => !analysing.joint_follows && analysing.since.elapsed() > DIM_AFTER,
            // A failed computation leaves the result of other settings.
            None => open.analysis.as_ref().is_some_and(|a| a.settings != open.settings),
        }
    }

    /// Returns the computation time of the result (ms); `None` without a result, or for pictures that are compared.
    pub fn elapsed_ms(&self) -> Option<f64> {
        let (_, analysis) = self.analysed()?;
        self.workspace
            .fixed_elapsed_ms
            .or_else(|| of_run::tells_durations().then(|| analysis.total_ms()))
    }

    /// Returns the time of the active deployment's first measurement (s).
    pub fn start_s(&self) -> f64 {
        self.active().map_or(0.0, OpenDeployment::start_s)
    }

    /// Advances playback, computations and toasts to a time (s, the window's clock); returns the time at which the next toast expires.
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
