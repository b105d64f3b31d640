//! The window's state, and the one place where it changes.
//!
//! Panes get the state to read and a list to put commands on; [`State::handle`] carries them out between frames.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui;

use super::plots::PreparedPlots;
use super::scene::ViewPreset;
use super::worker::{Reply, Source, Worker};
use crate::analysis::{Analysis, Settings};
use crate::deployment::{Deployment, Sample};
use crate::export;

/// What a pane asks for.
#[derive(Clone, Debug)]
pub enum Command {
    OpenPath(PathBuf),
    OpenSample(Sample),
    OpenFolderDialog,
    OpenFileDialog,
    Set(Settings),
    Show(Visibility),
    MoveCursor(f64),
    Look(ViewPreset),
    Copy(String),
    OpenInRerun,
    SaveRecordingDialog,
    ResetLayout,
    DismissNotice,
}

pub type Commands = Vec<Command>;

/// What the scene shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Visibility {
    pub stations: [bool; 3],
    pub raw: bool,
    pub tracks: bool,
    pub control_points: bool,
    /// Pairs of prisms in the plots.
    pub pairs: [bool; 3],
}

impl Default for Visibility {
    fn default() -> Self {
        Self {
            stations: [true; 3],
            raw: true,
            tracks: true,
            control_points: true,
            pairs: [true; 3],
        }
    }
}

/// One line at the top of the window until it is dismissed or replaced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Notice {
    Error(String),
    Done(String),
}

/// How long an answer may be late before it is dimmed: a slider that is answered at once must not flicker.
const DIM_AFTER: Duration = Duration::from_millis(80);

/// A dialog that closes before this was never seen.
const QUICKEST_CANCEL: Duration = Duration::from_millis(300);

pub struct State {
    worker: Worker,
    pub deployment: Option<Arc<Deployment>>,
    /// Of each station; found once, because the window asks in every frame.
    pub longest_range_m: [f64; 3],
    /// Counts the deployments shown; changes with the deployment.
    pub deployment_number: u64,
    pub settings: Settings,
    /// The newest answer; older than the settings while [`State::is_stale`].
    pub analysis: Option<Arc<Analysis>>,
    /// Its plots.
    pub plots: Arc<PreparedPlots>,
    /// Number of the request that the answer belongs to; changes with it.
    pub analysis_run: u64,
    pub visibility: Visibility,
    /// The time cursor (s, in the stations' clock).
    pub cursor_s: Option<f64>,
    pub notice: Option<Notice>,
    /// Pictures that are compared byte for byte show this instead of the measured time (ms).
    pub fixed_elapsed_ms: Option<f64>,
    opening: Option<u64>,
    analysing: Option<(u64, Instant)>,
}

impl State {
    pub fn new(ctx: egui::Context) -> Self {
        Self {
            worker: Worker::start(ctx),
            deployment: None,
            longest_range_m: [0.0; 3],
            deployment_number: 0,
            settings: Settings::default(),
            analysis: None,
            plots: Arc::default(),
            analysis_run: 0,
            visibility: Visibility::default(),
            cursor_s: None,
            notice: None,
            fixed_elapsed_ms: None,
            opening: None,
            analysing: None,
        }
    }

    /// Shows a deployment, from the next answer on.
    pub fn show(&mut self, deployment: Arc<Deployment>) {
        self.analysis = None;
        self.cursor_s = None;
        self.longest_range_m = deployment
            .tracks
            .each_ref()
            .map(|track| track.measurements.iter().map(|m| m.range_m).fold(0.0, f64::max));
        self.deployment = Some(deployment);
        self.deployment_number += 1;
        self.analyse();
    }

    /// Whether anything is being opened or calibrated.
    pub fn is_busy(&self) -> bool {
        self.opening.is_some() || self.analysing.is_some()
    }

    /// Whether the answer shown is old enough to be dimmed.
    pub fn is_stale(&self) -> bool {
        self.analysing.is_some_and(|(_, since)| since.elapsed() > DIM_AFTER)
    }

    /// How long the answer took (ms), once there is one.
    pub fn elapsed_ms(&self) -> Option<f64> {
        let analysis = self.analysis.as_ref()?;
        Some(self.fixed_elapsed_ms.unwrap_or_else(|| analysis.total_ms()))
    }

    /// Time of the first measurement (s): what the plots count from.
    pub fn start_s(&self) -> f64 {
        self.deployment.as_ref().and_then(|d| d.start_s()).unwrap_or(0.0)
    }

    /// Takes in what the worker has done since the last frame.
    pub fn take_replies(&mut self) {
        while let Some(reply) = self.worker.try_reply() {
            self.take(reply);
        }
    }

    /// Waits until nothing is under way; for pictures and tests.
    pub fn settle(&mut self) {
        while self.is_busy() {
            match self.worker.wait_reply() {
                Some(reply) => self.take(reply),
                None => break,
            }
        }
    }

    fn take(&mut self, reply: Reply) {
        match reply {
            Reply::Opened(number, result) => {
                if self.opening != Some(number) {
                    return;
                }
                self.opening = None;
                match result {
                    Ok(deployment) => {
                        self.notice = None;
                        self.show(deployment);
                    }
                    Err(line) => self.notice = Some(Notice::Error(line)),
                }
            }
            Reply::Analysed(number, analysis, plots) => {
                if self.analysing.is_some_and(|(newest, _)| newest == number) {
                    self.analysing = None;
                    if self.cursor_s.is_none() {
                        // So that the rig is seen before anything is clicked.
                        let time_s = &analysis.pipeline.triplets.time_s;
                        self.cursor_s = time_s.get(time_s.len() / 2).copied();
                    }
                    self.analysis = Some(analysis);
                    self.plots = plots;
                    self.analysis_run = number;
                }
            }
            Reply::Failed(number) => {
                self.opening = self.opening.filter(|newest| *newest != number);
                self.analysing = self.analysing.filter(|(newest, _)| *newest != number);
                self.notice = Some(Notice::Error(
                    "a bug in resect stopped the calculation; please report it with the data and the settings".to_owned(),
                ));
            }
            Reply::Picked(path) => self.open(Source::Path(path)),
            Reply::Done(Ok(line)) => self.notice = Some(Notice::Done(line)),
            Reply::Done(Err(line)) => self.notice = Some(Notice::Error(line)),
        }
    }

    /// Carries out a command; those of the window itself (layout, camera) are left to the caller.
    pub fn handle(&mut self, command: Command, ctx: &egui::Context) {
        match command {
            Command::OpenPath(path) => self.open(Source::Path(path)),
            Command::OpenSample(sample) => self.open(Source::Sample(sample)),
            Command::OpenFolderDialog => {
                let dialog = rfd::AsyncFileDialog::new()
                    .set_title("Open a deployment's folder")
                    .pick_folder();
                self.pick(dialog);
            }
            Command::OpenFileDialog => {
                let dialog = rfd::AsyncFileDialog::new()
                    .set_title("Open a deployment's tracks")
                    .add_filter("Tracks (bag, csv)", &["bag", "csv"])
                    .add_filter("All files", &["*"])
                    .pick_file();
                self.pick(dialog);
            }
            Command::Set(settings) => {
                if settings != self.settings {
                    self.settings = settings;
                    self.analyse();
                }
            }
            Command::Show(visibility) => self.visibility = visibility,
            Command::MoveCursor(time_s) => self.cursor_s = Some(time_s),
            Command::Copy(text) => ctx.copy_text(text),
            Command::OpenInRerun => self.with_analysis(|deployment, analysis| {
                let result = export::rerun::open_viewer(&deployment, &analysis)
                    .map(|()| "shown in the Rerun viewer".to_owned())
                    .map_err(|error| error.to_string());
                Some(Reply::Done(result))
            }),
            Command::SaveRecordingDialog => self.save_recording(),
            Command::DismissNotice => self.notice = None,
            Command::Look(_) | Command::ResetLayout => {}
        }
    }

    fn open(&mut self, source: Source) {
        self.opening = Some(self.worker.open(source));
    }

    fn analyse(&mut self) {
        if let Some(deployment) = &self.deployment {
            let number = self.worker.analyse(Arc::clone(deployment), self.settings);
            // The clock of a first request keeps running while newer ones replace it.
            let since = self.analysing.map_or_else(Instant::now, |(_, since)| since);
            self.analysing = Some((number, since));
        }
    }

    fn pick(&self, dialog: impl Future<Output = Option<rfd::FileHandle>> + Send + 'static) {
        self.worker.beside(move || {
            let asked = Instant::now();
            match pollster::block_on(dialog) {
                Some(picked) => Some(Reply::Picked(picked.path().to_owned())),
                // rfd does not tell a cancelled dialog from one that the system cannot show; nobody cancels this fast.
                None if asked.elapsed() < QUICKEST_CANCEL => Some(Reply::Done(Err(
                    "this system shows no file dialog (no desktop portal, no zenity); drop the folder or bag on the \
                     window, or start with `resect PATH`"
                        .to_owned(),
                ))),
                None => None,
            }
        });
    }

    fn save_recording(&self) {
        let name = self.deployment.as_ref().map_or("resect", |d| d.name.as_str()).replace('/', "_");
        let dialog = rfd::AsyncFileDialog::new()
            .set_title("Save a recording for Rerun")
            .set_file_name(format!("{name}.rrd"))
            .save_file();
        self.with_analysis(move |deployment, analysis| {
            let path = pollster::block_on(dialog)?.path().to_owned();
            let result = export::rerun::save(&deployment, &analysis, &path)
                .map(|()| format!("{} written", path.display()))
                .map_err(|error| error.to_string());
            Some(Reply::Done(result))
        });
    }

    fn with_analysis(
        &self,
        job: impl FnOnce(Arc<Deployment>, Arc<Analysis>) -> Option<Reply> + Send + 'static,
    ) {
        if let (Some(deployment), Some(analysis)) = (&self.deployment, &self.analysis) {
            let (deployment, analysis) = (Arc::clone(deployment), Arc::clone(analysis));
            self.worker.beside(move || job(deployment, analysis));
        }
    }
}
