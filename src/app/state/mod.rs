//! The window's state, and the one place where it changes.
//!
//! Panes get the state to read and a list to put [`Command`]s on; [`State::handle`] carries them out between frames.

mod advice;
mod asked;
mod asking;
mod channels_csv;
mod deployment_toml;
mod handle;
mod hovering;
mod judging;
mod live;
mod looking;
mod naming;
mod opening;
mod outcomes;
mod picture;
mod planning;
pub mod put_right;
mod restoring;
mod results;
mod saving;
mod sessions;
mod validating;

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

pub use asking::OpenPrompt;
pub use hovering::Hovering;
pub use opening::Opening;
pub use sessions::SessionState;

use super::file_dialog;
use super::jobs::Jobs;
use super::layout::Layout;
use super::model::View;
use super::prepared::analyser::Analyser;
use crate::app::model::live::Live;
use crate::app::model::studies::Studies;
use crate::app::model::toasts::Toasts;
use crate::app::model::{
    Analysing, Asked, Colouring, OpenDeployment, Overlay, PictureTo, Planning, Playback, Plotted,
    Results, Ruler, SceneOptions, UndoStack, Units, Validations, Visibility, WayPlots,
};
use resect_core::analysis::{Analysis, Settings};
use resect_core::progress::Progress;
use resect_report::of_run;

/// How long an answer may be late before it is dimmed: a slider that is answered at once must not flicker.
const DIM_AFTER: Duration = Duration::from_millis(80);

pub struct State {
    jobs: Jobs<Self>,
    analyser: Analyser,
    /// The open deployments, in the order they were opened.
    pub open: Vec<OpenDeployment>,
    /// Index of the open deployment that the panes show.
    active: usize,
    newest_id: u64,
    /// What the next deployment starts with.
    pub start_settings: Settings,
    pub visibility: Visibility,
    pub colouring: Colouring,
    pub scene: SceneOptions,
    pub view: View,
    pub layout: Layout,
    pub ruler: Ruler,
    pub playback: Playback,
    /// Time under the pointer in the last frame, in whichever pane (s, in the stations' clock).
    pub hover_s: Option<f64>,
    pub undo: UndoStack,
    pub results: Results,
    pub units: Units,
    /// What the pane of channels plots.
    pub plotted: Plotted,
    /// What the pane of the trajectory plots.
    pub way_plots: WayPlots,
    pub planning: Planning,
    /// Trajectories that came with the deployment that is being opened.
    estimates_to_come: Vec<PathBuf>,
    pub theme: egui::ThemePreference,
    pub overlay: Overlay,
    pub studies: Studies,
    pub validations: Validations,
    pub live: Live,
    /// Whether type is large and contrast full.
    pub in_the_sun: bool,
    /// The dialog for a path inside the window.
    pub prompt: Option<OpenPrompt>,
    /// What the user is asked before it goes on, one after the other.
    asked: VecDeque<asked::Waiting>,
    /// Whether paths are asked for inside the window: the system has no dialog.
    pub asks_in_window: bool,
    /// Where the last path was chosen to open something, and to save something.
    last_folder_opened: Option<PathBuf>,
    last_folder_saved: Option<PathBuf>,
    pub toasts: Toasts,
    /// Pictures that are compared byte for byte show this instead of the measured time (ms).
    pub fixed_elapsed_ms: Option<f64>,
    /// What is being read.
    pub opening: Vec<Opening>,
    /// Requests that find out what a path is.
    looking: Vec<u64>,
    pub hovering: Hovering,
    pub session: SessionState,
    /// Asked for in the last frame; taken in the next, when the menu that asked for it is gone.
    wanted_picture: Option<PictureTo>,
    /// Whether this frame may become a picture: controls are not part of it.
    pub picturing: bool,
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
            open: Vec::new(),
            active: 0,
            newest_id: 0,
            start_settings: Settings::default(),
            visibility: Visibility::default(),
            colouring: Colouring::default(),
            scene: SceneOptions::default(),
            view: View::default(),
            layout: Layout::default(),
            ruler: Ruler::default(),
            playback: Playback::default(),
            hover_s: None,
            undo: UndoStack::default(),
            results: Results::default(),
            units: Units::default(),
            plotted: Plotted::default(),
            way_plots: WayPlots::default(),
            planning: Planning::default(),
            estimates_to_come: Vec::new(),
            theme,
            overlay: Overlay::None,
            studies: Studies::default(),
            validations: Validations::default(),
            live: Live::default(),
            in_the_sun: false,
            prompt: None,
            asked: VecDeque::new(),
            asks_in_window: !file_dialog::system::is_there(),
            last_folder_opened: None,
            last_folder_saved: None,
            toasts: Toasts::default(),
            fixed_elapsed_ms: None,
            opening: Vec::new(),
            looking: Vec::new(),
            hovering: Hovering::default(),
            session: SessionState::default(),
            wanted_picture: None,
            picturing: false,
        }
    }

    /// What the panes show.
    pub fn active(&self) -> Option<&OpenDeployment> {
        self.open.get(self.active)
    }

    /// The active deployment with its newest answer, once there is one.
    pub fn analysed(&self) -> Option<(&OpenDeployment, &Arc<Analysis>)> {
        let active = self.active()?;
        Some((active, active.analysis.as_ref()?))
    }

    /// The settings of the active deployment, or what the next one starts with.
    pub fn settings(&self) -> &Settings {
        self.active().map_or(&self.start_settings, |open| &open.settings)
    }

    /// What the user is asked, if anything.
    pub fn asked(&self) -> Option<&Asked> {
        self.asked.front().map(|waiting| &waiting.asked)
    }

    /// Whether anything is being opened, saved as a session, calibrated, studied or validated.
    pub fn is_busy(&self) -> bool {
        let analysing = self.open.iter().any(|open| open.analysing.is_some());
        let listing = self.prompt.as_ref().is_some_and(|prompt| prompt.shown.is_reading());
        !self.opening.is_empty()
            || !self.looking.is_empty()
            || self.session.is_busy()
            || listing
            || analysing
            || self.studies.running.is_some()
            || self.validations.running.is_some()
            || self.planning.foreseen.is_running()
            || self.planning.better.is_running()
            || self.open.iter().any(OpenDeployment::is_making)
    }

    /// What is being calibrated for longer than this, and how far it is.
    pub fn calibrating(
        &self,
        longer_than: Duration,
    ) -> impl Iterator<Item = (&OpenDeployment, &Progress)> {
        let long = move |open: &&OpenDeployment| {
            open.analysing.is_some_and(|analysing| analysing.since.elapsed() > longer_than)
        };
        let long = self.open.iter().filter(long);
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
        self.fixed_elapsed_ms.or_else(|| of_run::tells_durations().then(|| analysis.total_ms()))
    }

    /// Time of the active deployment's first measurement (s).
    pub fn start_s(&self) -> f64 {
        self.active().map_or(0.0, OpenDeployment::start_s)
    }

    /// Moves what moves by itself on to this time of the window's clock (s); gives when something will go next.
    pub fn advance(&mut self, now_s: f64) -> Option<f64> {
        if let Some(open) = self.open.get_mut(self.active) {
            self.playback.advance(&mut open.timeline, now_s);
        }
        self.make_what_is_looked_at();
        let hand_is_on = self.jobs.ctx().input(|input| input.pointer.any_down());
        self.foresee(hand_is_on);
        self.toasts.advance(now_s)
    }

    fn analyse(&mut self, index: usize) {
        let Some(open) = self.open.get_mut(index) else { return };
        let number = self.jobs.next_number();
        self.analyser.analyse(number, open.id, Arc::clone(&open.deployment), open.settings);
        // The clock of a first request keeps running while newer ones replace it, until something is shown.
        let awaited = open.analysing.filter(|analysing| !analysing.joint_follows);
        let since = awaited.map_or_else(Instant::now, |analysing| analysing.since);
        open.analysing = Some(Analysing { number, since, joint_follows: false });
    }
}
