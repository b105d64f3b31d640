//! Everything that can be asked for. Panes send these; `State::handle` carries them out.
//!
//! Each part of the state has its own commands: those of plans and of live deployments are in `planning.rs` and `live.rs`.

use std::path::PathBuf;

use super::Units;
use super::studies::StudyOptions;
use super::{Added, Asked, AskedAnswer, ChannelPlots, Lookup, Palette, Picked, Visibility};
use super::{Colouring, Ruler, SceneOptions, ViewPreset};
use super::{LayoutPreset, LiveCommand, Pane, PlanCommand};
use crate::app::file_dialog::PromptCommand;
use resect_core::analysis::Settings;
use resect_io::sample::Sample;
use resect_io::source::{Extras, Source};
use resect_report::copy::{CopyFormat, Part};

/// A request of a pane, by the part of the state that it changes.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "a frame has a few at most")]
pub enum Command {
    Deployment(DeploymentCommand),
    Time(TimeCommand),
    Scene(SceneCommand),
    Results(ResultsCommand),
    Judging(JudgingCommand),
    Plan(PlanCommand),
    Live(LiveCommand),
    Session(SessionCommand),
    Dialog(DialogCommand),
    Workspace(WorkspaceCommand),
}

pub type Commands = Vec<Command>;

/// The open deployments, their settings and data, and undo.
#[derive(Clone, Debug)]
pub enum DeploymentCommand {
    /// Opens all that the readers know: tracks, folders, control points, a rig, GNSS, settings, sessions.
    OpenPaths(Vec<PathBuf>),
    OpenSample(Sample),
    /// Opens a former deployment again.
    OpenSource(Source),
    /// Stops reading a deployment, by its request's number.
    CancelOpening(u64),
    OpenFolderDialog,
    OpenFileDialog,
    /// Shows another of the open deployments, by its id.
    Activate(u64),
    Close(u64),

    /// Sets the settings of the active deployment.
    Set(Settings),
    /// Gives every open deployment the active one's settings.
    SetAll,
    /// Stops calibrating a deployment, by its id, and returns to the settings of the answer that is shown.
    CancelAnalysis(u64),
    Undo,
    Redo,

    /// Reads the active deployment again with these beside its tracks, as a step that can be undone.
    PutRight(Extras),
    /// Unfolds the corrections of the data in their pane.
    ShowPutRight,
    ChooseRigDialog,
    AddControlPointsDialog,
    /// Asks whether the corrections are written to the folder's `deployment.toml`.
    WriteDeploymentToml,
}

/// The time cursor, the selection, playback, and values over time.
#[derive(Clone, Debug)]
pub enum TimeCommand {
    /// Time under the pointer (s, in the stations' clock); sent in every frame while it is there.
    Hover(f64),
    MoveCursor(f64),
    /// Moves the time cursor by so many triplets.
    StepCursor(i32),
    /// Span of time that the plots show (s, in the stations' clock).
    ShowTimes([f64; 2]),
    ShowAllTimes,
    Select(Option<[f64; 2]>),
    ZoomToSelection,
    TogglePlay,
    SetPlaySpeed(f64),
    /// A reading was picked in the scene: the plots come to it.
    PickInScene(Picked),
    /// A reading was picked in a plot or a list: the camera flies to it.
    PickInPlot(Picked),
    Unpick,
    /// Selects a span of time (s, in the stations' clock) and shows it in the plots and the scene.
    LookAtTimes([f64; 2]),
    /// Chooses the plots of the pane of channels, and shows it.
    Plot(ChannelPlots),
    /// Saves every value that the pane of channels shows.
    SaveChannelsDialog,
}

/// The camera and the content of the scene.
#[derive(Clone, Debug)]
pub enum SceneCommand {
    Show(Visibility),
    Colour(Colouring),
    SetOptions(SceneOptions),
    Measure(Ruler),
    Look(ViewPreset),
    /// The camera glides to a place (m, in station 1's frame).
    ComeTo(nalgebra::Vector3<f64>),
    /// Brings a control point before the camera.
    LookAtPoint {
        file: String,
        marker: i64,
    },
    Picture(PictureTo),
}

/// Answers: runs, pins, studies, the validation, and their export.
#[derive(Clone, Debug)]
pub enum ResultsCommand {
    /// Pins the active deployment's result.
    Pin,
    /// Pins the result of a run, by its id.
    PinRun(u64),
    Unpin(u64),
    /// Shows or hides the residuals of a pinned result.
    ShowPin(u64, bool),
    /// Gives the active deployment the settings of a pinned result, by its id.
    UsePinned(u64),
    /// Gives the active deployment the settings of a run, by its id.
    RestoreRun(u64),

    /// Validates the active deployment's calibration with the others that are open.
    ValidateOthers,

    SetStudy(StudyOptions),
    RunStudy,
    CancelStudy,
    SaveStudyDialog,

    /// Copies transforms of the active deployment's answer.
    CopyTransforms(CopyFormat, Part),
    OpenInRerun,
    SaveRecordingDialog,
    SaveTrajectoryDialog,
    SaveReportDialog,
}

/// Trajectories of other systems that are judged by the active deployment.
#[derive(Clone, Debug)]
pub enum JudgingCommand {
    /// Reads trajectories and adds them to those of the active deployment.
    Add(Vec<PathBuf>),
    AddDialog,
    /// The trajectories of the active deployment, each with its options.
    Set(Vec<Added>),
}

/// The session and its file.
#[derive(Clone, Debug)]
pub enum SessionCommand {
    OpenDialog,
    /// Closes all that was restored after a crash.
    DiscardRecovered,
    /// Opens the deployments that a session replaced, or that the last window had.
    ReopenLast,
    /// Saves to the session's file, which is asked for the first time.
    Save,
    SaveAs,
    /// Opens again the session's deployments that could not be opened.
    RetryMissing,
    /// Takes a deployment that could not be opened out of the session, by its place among those.
    ForgetMissing(usize),
}

/// Dialogs, questions, and sheets above the panes.
#[derive(Clone, Debug)]
pub enum DialogCommand {
    /// An input in the prompt for a path.
    Prompt(PromptCommand),
    /// Files hover over the window.
    HoverPaths(Vec<PathBuf>),
    /// A choice in a question of the window.
    EditAsked(Asked),
    AnswerAsked(AskedAnswer),
    CancelAsked,

    ShowPalette,
    /// The text of the command palette and its chosen line.
    EditPalette(Palette),
    ShowShortcuts,
    /// Explains the word under the pointer or with the focus; all words where there is none.
    Explain,
    /// The text that is looked up in the glossary.
    LookUp(Lookup),
    /// Closes the palette, the sheet of shortcuts or the glossary.
    CloseOverlay,
}

/// The panes, units, colours, clipboard and toasts of the window itself.
#[derive(Clone, Debug)]
pub enum WorkspaceCommand {
    /// Brings a pane to the front.
    ShowPane(Pane),
    UseLayout(LayoutPreset),
    ResetLayout,
    SetUnits(Units),
    UseTheme(egui::ThemePreference),
    /// Large type and full contrast, to be read in the sun.
    ReadInTheSun(bool),
    Copy(String),
    DismissToast(u64),
    /// The pointer is on a toast.
    HoldToast(u64),
}

/// Where a picture of the scene goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureTo {
    File,
    Clipboard,
}

impl From<DeploymentCommand> for Command {
    fn from(command: DeploymentCommand) -> Self {
        Self::Deployment(command)
    }
}

impl From<TimeCommand> for Command {
    fn from(command: TimeCommand) -> Self {
        Self::Time(command)
    }
}

impl From<SceneCommand> for Command {
    fn from(command: SceneCommand) -> Self {
        Self::Scene(command)
    }
}

impl From<ResultsCommand> for Command {
    fn from(command: ResultsCommand) -> Self {
        Self::Results(command)
    }
}

impl From<JudgingCommand> for Command {
    fn from(command: JudgingCommand) -> Self {
        Self::Judging(command)
    }
}

impl From<PlanCommand> for Command {
    fn from(command: PlanCommand) -> Self {
        Self::Plan(command)
    }
}

impl From<LiveCommand> for Command {
    fn from(command: LiveCommand) -> Self {
        Self::Live(command)
    }
}

impl From<SessionCommand> for Command {
    fn from(command: SessionCommand) -> Self {
        Self::Session(command)
    }
}

impl From<DialogCommand> for Command {
    fn from(command: DialogCommand) -> Self {
        Self::Dialog(command)
    }
}

impl From<WorkspaceCommand> for Command {
    fn from(command: WorkspaceCommand) -> Self {
        Self::Workspace(command)
    }
}
