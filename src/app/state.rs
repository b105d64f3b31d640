//! The window's state, and the one place where it changes.
//!
//! Panes get the state to read and a list to put commands on; [`State::handle`] carries them out between frames.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui;

use super::layout::Pane;
use super::open_deployment::OpenDeployment;
use super::plots::PreparedPlots;
use super::scene::ViewPreset;
use super::studies::{self, Studies, StudyOptions};
use super::worker::{Reply, Source, Worker};
use crate::analysis::{Analysis, Settings};
use crate::deployment::{Deployment, Sample};
use crate::evaluation::vehicle::{LARGEST_POSE_ERROR_M, vehicle_trajectory};
use crate::experiment::StudyError;
use crate::export;
use crate::progress::Progress;

/// What a pane asks for.
#[derive(Clone, Debug)]
pub enum Command {
    OpenPath(PathBuf),
    OpenSample(Sample),
    OpenFolderDialog,
    OpenFileDialog,
    /// Shows another of the open deployments, by its id.
    Activate(u64),
    Close(u64),
    /// Of the active deployment.
    Set(Settings),
    /// Gives every open deployment the active one's settings.
    SetAll,
    Show(Visibility),
    MoveCursor(f64),
    Look(ViewPreset),
    Copy(String),
    OpenInRerun,
    SaveRecordingDialog,
    SaveTrajectoryDialog,
    SetStudy(StudyOptions),
    RunStudy,
    CancelStudy,
    SaveStudyDialog,
    /// Brings a pane to the front.
    ShowPane(Pane),
    ResetLayout,
    DismissNotice,
}

pub type Commands = Vec<Command>;

/// What the scene and the plots show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Visibility {
    pub stations: [bool; 3],
    pub raw: bool,
    pub tracks: bool,
    pub control_points: bool,
    /// The vehicle's frame along the track.
    pub poses: bool,
    /// What the interpolation states about its own error: ellipsoids in the scene, bands in the plot.
    pub uncertainty: bool,
    /// What the answer states about where stations 2 and 3 stand.
    pub station_ellipsoids: bool,
    /// Arrows at stations 2 and 3 along what the drive leaves free or weak.
    pub weak_directions: bool,
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
            poses: true,
            uncertainty: true,
            station_ellipsoids: true,
            weak_directions: true,
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
    /// In the order they were opened.
    pub open: Vec<OpenDeployment>,
    /// Which of them the panes show.
    active: usize,
    newest_id: u64,
    /// What the next deployment starts with.
    pub start_settings: Settings,
    pub visibility: Visibility,
    pub studies: Studies,
    pub notice: Option<Notice>,
    /// Pictures that are compared byte for byte show this instead of the measured time (ms).
    pub fixed_elapsed_ms: Option<f64>,
    opening: Vec<u64>,
    /// The request whose deployment gives way to the first that the user opens.
    placeholder: Option<u64>,
}

impl State {
    pub fn new(ctx: egui::Context) -> Self {
        Self {
            worker: Worker::start(ctx),
            open: Vec::new(),
            active: 0,
            newest_id: 0,
            start_settings: Settings::default(),
            visibility: Visibility::default(),
            studies: Studies::default(),
            notice: None,
            fixed_elapsed_ms: None,
            opening: Vec::new(),
            placeholder: None,
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

    /// Those of the active deployment, or what the next one starts with.
    pub fn settings(&self) -> &Settings {
        self.active().map_or(&self.start_settings, |open| &open.settings)
    }

    /// Opens a deployment, shows it, and calibrates it.
    pub fn add(&mut self, deployment: Arc<Deployment>) {
        self.open.retain(|open| !open.placeholder);
        self.newest_id += 1;
        self.open.push(OpenDeployment::new(self.newest_id, deployment, self.start_settings));
        self.active = self.open.len() - 1;
        self.analyse(self.active);
    }

    /// Opens the sample that is there until the user opens something.
    pub fn open_placeholder(&mut self, sample: Sample) {
        self.open_source(Source::Sample(sample));
        self.placeholder = self.opening.last().copied();
    }

    /// Whether anything is being opened, calibrated or studied.
    pub fn is_busy(&self) -> bool {
        let analysing = self.open.iter().any(|open| open.analysing.is_some());
        !self.opening.is_empty() || analysing || self.studies.running.is_some()
    }

    /// Whether the answer shown is old enough to be dimmed.
    pub fn is_stale(&self) -> bool {
        let since = self.active().and_then(|open| open.analysing);
        since.is_some_and(|(_, since)| since.elapsed() > DIM_AFTER)
    }

    /// How long the answer took (ms), once there is one.
    pub fn elapsed_ms(&self) -> Option<f64> {
        let (_, analysis) = self.analysed()?;
        Some(self.fixed_elapsed_ms.unwrap_or_else(|| analysis.total_ms()))
    }

    /// Time of the active deployment's first measurement (s).
    pub fn start_s(&self) -> f64 {
        self.active().map_or(0.0, OpenDeployment::start_s)
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
            Reply::Opened(number, result) => self.take_opened(number, result),
            Reply::Analysed { number, id, analysis, plots } => {
                self.take_analysed(number, id, analysis, plots);
            }
            Reply::Studied(number, result) => {
                if self.studies.running.as_ref().is_none_or(|(running, _)| *running != number) {
                    return;
                }
                self.studies.running = None;
                match result {
                    Ok(result) => self.studies.result = Some(result),
                    Err(StudyError::Cancelled) => {}
                    Err(error) => self.notice = Some(Notice::Error(error.to_string())),
                }
            }
            Reply::Failed(number) => {
                self.opening.retain(|opening| *opening != number);
                for open in &mut self.open {
                    open.analysing = open.analysing.filter(|(newest, _)| *newest != number);
                }
                self.studies.running = self.studies.running.take().filter(|(n, _)| *n != number);
                self.notice = Some(Notice::Error(
                    "a bug in resect stopped the calculation; please report it with the data and the settings".to_owned(),
                ));
            }
            Reply::Picked(path) => self.open_source(Source::Path(path)),
            Reply::Done(Ok(line)) => self.notice = Some(Notice::Done(line)),
            Reply::Done(Err(line)) => self.notice = Some(Notice::Error(line)),
        }
    }

    fn take_opened(&mut self, number: u64, result: Result<Arc<Deployment>, String>) {
        self.opening.retain(|opening| *opening != number);
        match result {
            Ok(deployment) => {
                self.notice = None;
                self.add(deployment);
                if self.placeholder == Some(number) {
                    self.open[self.active].placeholder = true;
                }
            }
            Err(line) => self.notice = Some(Notice::Error(line)),
        }
    }

    fn take_analysed(
        &mut self,
        number: u64,
        id: u64,
        analysis: Arc<Analysis>,
        plots: Arc<PreparedPlots>,
    ) {
        if let Some(open) = self.open.iter_mut().find(|open| open.id == id) {
            open.take(number, analysis, plots);
        }
    }

    /// Carries out a command; those of the window itself (layout, camera) are left to the caller.
    pub fn handle(&mut self, command: Command, ctx: &egui::Context) {
        match command {
            Command::OpenPath(path) => self.open_source(Source::Path(path)),
            Command::OpenSample(sample) => self.open_source(Source::Sample(sample)),
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
            Command::Activate(id) => {
                if let Some(index) = self.open.iter().position(|open| open.id == id) {
                    self.active = index;
                }
            }
            Command::Close(id) => self.close(id),
            Command::Set(settings) => self.set(self.active, settings),
            Command::SetAll => {
                let settings = *self.settings();
                for index in 0..self.open.len() {
                    self.set(index, settings);
                }
            }
            Command::Show(visibility) => self.visibility = visibility,
            Command::MoveCursor(time_s) => {
                if let Some(open) = self.open.get_mut(self.active) {
                    open.cursor_s = Some(time_s);
                }
            }
            Command::Copy(text) => ctx.copy_text(text),
            Command::OpenInRerun => self.with_analysis(|deployment, analysis| {
                let result = export::rerun::open_viewer(&deployment, &analysis)
                    .map(|()| "shown in the Rerun viewer".to_owned())
                    .map_err(|error| error.to_string());
                Some(Reply::Done(result))
            }),
            Command::SaveRecordingDialog => self.save_recording(),
            Command::SaveTrajectoryDialog => self.save_trajectory(),
            Command::SetStudy(options) => self.studies.options = options,
            Command::RunStudy => self.run_study(),
            Command::CancelStudy => {
                if let Some((_, progress)) = &self.studies.running {
                    progress.cancel();
                }
            }
            Command::SaveStudyDialog => self.save_study(),
            Command::DismissNotice => self.notice = None,
            Command::Look(_) | Command::ShowPane(_) | Command::ResetLayout => {}
        }
    }

    fn set(&mut self, index: usize, settings: Settings) {
        let Some(open) = self.open.get_mut(index) else { return };
        if open.settings != settings {
            open.settings = settings;
            open.placeholder = false;
            self.analyse(index);
        }
    }

    fn close(&mut self, id: u64) {
        let Some(index) = self.open.iter().position(|open| open.id == id) else { return };
        self.open.remove(index);
        self.worker.forget(id);
        // The one shown stays shown; of a closed one, its neighbour.
        if index < self.active || self.active == self.open.len() {
            self.active = self.active.saturating_sub(1);
        }
    }

    fn open_source(&mut self, source: Source) {
        let number = self.worker.open(source);
        self.opening.push(number);
    }

    fn analyse(&mut self, index: usize) {
        let Some(open) = self.open.get_mut(index) else { return };
        let number = self.worker.analyse(open.id, Arc::clone(&open.deployment), open.settings);
        // The clock of a first request keeps running while newer ones replace it.
        let since = open.analysing.map_or_else(Instant::now, |(_, since)| since);
        open.analysing = Some((number, since));
    }

    fn run_study(&mut self) {
        let options = self.studies.options;
        let deployments: Vec<Arc<Deployment>> = if options.all_open {
            self.open.iter().map(|open| Arc::clone(&open.deployment)).collect()
        } else {
            self.active().map(|open| Arc::clone(&open.deployment)).into_iter().collect()
        };
        let settings = *self.settings();
        let progress = Arc::new(Progress::default());
        let shared = Arc::clone(&progress);
        let number = self
            .worker
            .study(move || studies::run(&options, &deployments, &settings, &shared).map(Arc::new));
        self.studies.running = Some((number, progress));
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

    /// A dialog for a file named after the deployment.
    fn save_dialog(
        &self,
        title: &str,
        extension: &str,
    ) -> impl Future<Output = Option<rfd::FileHandle>> + use<> {
        let name = self.active().map_or("resect", |open| open.deployment.name.as_str());
        rfd::AsyncFileDialog::new()
            .set_title(title)
            .set_file_name(format!("{}.{extension}", name.replace('/', "_")))
            .save_file()
    }

    fn save_recording(&self) {
        let dialog = self.save_dialog("Save a recording for Rerun", "rrd");
        self.with_analysis(move |deployment, analysis| {
            let path = pollster::block_on(dialog)?.path().to_owned();
            let result = export::rerun::save(&deployment, &analysis, &path)
                .map(|()| format!("{} written", path.display()))
                .map_err(|error| error.to_string());
            Some(Reply::Done(result))
        });
    }

    fn save_trajectory(&self) {
        let dialog = self.save_dialog("Save the vehicle's trajectory (TUM)", "tum");
        self.with_analysis(move |deployment, analysis| {
            let path = pollster::block_on(dialog)?.path().to_owned();
            let result = trajectory_text(&deployment, &analysis).and_then(|text| {
                std::fs::write(&path, text)
                    .map(|()| format!("{} written", path.display()))
                    .map_err(|error| format!("{}: {error}", path.display()))
            });
            Some(Reply::Done(result))
        });
    }

    fn save_study(&self) {
        let Some(result) = self.studies.result.clone() else { return };
        let dialog = rfd::AsyncFileDialog::new()
            .set_title("Save CSV, SVG and PNG into a folder")
            .pick_folder();
        self.worker.beside(move || {
            let folder = pollster::block_on(dialog)?.path().to_owned();
            let written = export::study::write(result.study(), &folder);
            Some(Reply::Done(
                written
                    .map(|files| format!("{} files written to {}", files.len(), folder.display()))
                    .map_err(|error| error.to_string()),
            ))
        });
    }

    fn with_analysis(
        &self,
        job: impl FnOnce(Arc<Deployment>, Arc<Analysis>) -> Option<Reply> + Send + 'static,
    ) {
        if let Some((open, analysis)) = self.analysed() {
            let (deployment, analysis) = (Arc::clone(&open.deployment), Arc::clone(analysis));
            self.worker.beside(move || job(deployment, analysis));
        }
    }
}

fn trajectory_text(deployment: &Deployment, analysis: &Analysis) -> Result<String, String> {
    let answer = analysis.answer.as_ref().map_err(ToString::to_string)?;
    let (trajectory, _) = vehicle_trajectory(
        deployment,
        analysis.triplets(),
        analysis.offer.targets,
        &answer.calibration.station1_from_station,
        LARGEST_POSE_ERROR_M,
    )
    .map_err(|error| error.to_string())?;
    let calibration = &answer.calibration;
    let header = format!(
        "{}: frame of station 1, by method {}, verdict {}",
        deployment.name,
        calibration.method.letter(),
        calibration.verdict.name()
    );
    Ok(export::tum::tum(&trajectory, &header))
}
