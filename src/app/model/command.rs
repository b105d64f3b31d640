//! Commands that panes send; `State::handle` executes them.
//!
//! Commands of plans and of live deployments are in `planning.rs` and `live.rs`.

use std::path::PathBuf;

use super::Units;
use super::studies::StudyOptions;
use super::{Added, Asked, AskedAnswer, ChannelPlots, Lookup, Palette, Picked, Visibility};
use super::{Colouring, Ruler, SceneOptions, ViewPreset};
use super::{LayoutPreset, LiveCommand, Pane, PictureOrder, PictureTo, PlanCommand};
use crate::app::file_dialog::PromptCommand;
use resect_core::analysis::Settings;
use resect_io::sample::Sample;
use resect_io::source::{Extras, Source, TrajectoryFile};
use resect_report::copy::{CopiedTransforms, CopyFormat};

/// A command of a pane, by the component of the state that it changes.
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

/// Commands of the open deployments: settings, data and undo.
#[derive(Clone, Debug)]
pub enum DeploymentCommand {
    /// Opens all files that the readers know: tracks, folders, control points, a rig, GNSS, settings, sessions.
    OpenPaths(Vec<PathBuf>),
    OpenSample(Sample),
    /// Reopens an earlier deployment.
    OpenSource(Source),
    /// Cancels the reading of a deployment, by the number of its request.
    CancelOpening(u64),
    OpenFolderDialog,
    OpenFileDialog,
    /// Activates another open deployment, by its id.
    Activate(u64),
    Close(u64),
    /// Opens the deployment that was closed last, as it was.
    ReopenClosed,

    /// Sets the settings of the active deployment.
    Set(Settings),
    /// Copies the settings of the active deployment to all open ones.
    SetAll,
    /// Cancels the calibration of a deployment, by its id, and restores the settings of the displayed result.
    CancelAnalysis(u64),
    Undo,
    Redo,

    /// Reads the active deployment again with these extras beside its tracks; undoable.
    Correct(Extras),
    /// Shows the corrections of the data in their pane.
    ShowCorrections,
    ChooseRigDialog,
    AddControlPointsDialog,
    /// Asks for confirmation to write the corrections to the folder's `deployment.toml`.
    WriteDeploymentToml,
}

/// Commands of the time cursor, the selection, playback, and values over time.
#[derive(Clone, Debug)]
pub enum TimeCommand {
    /// Time under the pointer (s, the stations' clock), sent in every frame.
    Hover(f64),
    MoveCursor(f64),
    /// Moves the time cursor by this number of triplets.
    StepCursor(i32),
    /// Sets the time interval of the plots (s, the stations' clock).
    ShowTimes([f64; 2]),
    ShowAllTimes,
    Select(Option<[f64; 2]>),
    ZoomToSelection,
    TogglePlay,
    SetPlaySpeed(f64),
    /// Picks a reading in the scene: the plots show its time.
    PickInScene(Picked),
    /// Picks a reading in a plot or a list: the camera flies to it.
    PickInPlot(Picked),
    Unpick,
    /// Selects a time interval (s, the stations' clock) and shows it in the plots and the scene.
    LookAtTimes([f64; 2]),
    /// Selects the plots of the channels pane, and shows the pane.
    Plot(ChannelPlots),
    /// Saves all values in the channels pane.
    SaveChannelsDialog,
}

/// Commands of the camera and the content of the scene.
#[derive(Clone, Debug)]
pub enum SceneCommand {
    Show(Visibility),
    Colour(Colouring),
    SetOptions(SceneOptions),
    Measure(Ruler),
    Look(ViewPreset),
    /// Moves the camera smoothly to a position (m, station 1's frame).
    ComeTo(nalgebra::Vector3<f64>),
    /// Points the camera at a control point.
    LookAtPoint {
        file: String,
        marker: i64,
    },
    /// Ends the emphasis of that control point.
    ForgetPoint,
}

/// Commands of results: runs, pins, studies, the validation, and their export.
#[derive(Clone, Debug)]
pub enum ResultsCommand {
    /// Pins the result of the active deployment.
    Pin,
    /// Pins the result of a run, by its id.
    PinRun(u64),
    Unpin(u64),
    /// Shows or hides the residuals of a pinned result.
    ShowPin(u64, bool),
    /// Applies the settings of a pinned result, by its id, to the active deployment.
    UsePinned(u64),
    /// Applies the settings of a run, by its id, to the active deployment.
    RestoreRun(u64),

    /// Validates the calibration of the active deployment on the other open deployments.
    ValidateOthers,

    SetStudy(StudyOptions),
    RunStudy,
    CancelStudy,
    SaveStudyDialog,

    /// Copies transforms of the active deployment's result.
    CopyTransforms(CopyFormat, CopiedTransforms),
    OpenInRerun,
    SaveRecordingDialog,
    SaveTrajectoryDialog,
    SaveReportDialog,
}

/// Commands of estimated trajectories, which are evaluated against the active deployment.
#[derive(Clone, Debug)]
pub enum JudgingCommand {
    /// Reads trajectories and adds them to the active deployment.
    Add(Vec<PathBuf>),
    AddDialog,
    /// Sets the trajectories of the active deployment, each with its options.
    Set(Vec<Added>),
    /// Reads a ground truth that is a trajectory again, with other options of its file.
    ReadGroundTruth(TrajectoryFile),
    /// Estimates the pose of each trajectory's body in the ground truth's, as long as it is shown.
    ShowExtrinsics(bool),
    /// Opens the trajectory of this colour as the ground truth, and moves the others of the active deployment to it. A ground truth that is a
    /// trajectory itself becomes one of the others.
    UseAsGroundTruth(usize),
}

/// Commands of the session and its file.
#[derive(Clone, Debug)]
pub enum SessionCommand {
    OpenDialog,
    /// Closes all deployments restored after a crash.
    DiscardRecovered,
    /// Reopens the deployments that a session replaced, or those of the last window.
    ReopenLast,
    /// Saves to the session's file; asks for a path the first time.
    Save,
    SaveAs,
    /// Retries the session's deployments that could not be opened.
    RetryMissing,
    /// Removes a deployment that could not be opened from the session, by its index among those.
    ForgetMissing(usize),
}

/// Commands of dialogs, questions, and sheets above the panes.
#[derive(Clone, Debug)]
pub enum DialogCommand {
    /// User input in the prompt for a path.
    Prompt(PromptCommand),
    /// Files hover over the window.
    HoverPaths(Vec<PathBuf>),
    /// Changes the choices in an open question.
    EditAsked(Asked),
    AnswerAsked(AskedAnswer),
    CancelAsked,

    ShowPalette,
    /// Sets the text and the selected line of the command palette.
    EditPalette(Palette),
    ShowShortcuts,
    /// Asks for size, scale and format of a picture of a pane.
    ShowPicture(Pane),
    EditPicture(PictureOrder),
    /// Explains the term under the pointer or with the focus; shows all terms if there is none.
    Explain,
    /// Sets the search text of the glossary.
    LookUp(Lookup),
    ShowLicences,
    /// Closes the palette, the shortcut sheet or the glossary.
    CloseOverlay,
}

/// The way of the focus to a number: first the handle of its slider, then the field in which the user types.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingFocus {
    Handle(&'static str),
    Field(&'static str),
}

/// Commands of the window itself: panes, units, colours, clipboard and toasts.
#[derive(Clone, Debug)]
pub enum WorkspaceCommand {
    /// Activates a pane.
    ShowPane(Pane),
    UseLayout(LayoutPreset),
    ResetLayout,
    SetUnits(Units),
    UseTheme(egui::ThemePreference),
    /// Switches large type and full contrast, for reading in sunlight.
    ReadInTheSun(bool),
    /// Shows the Pipeline pane with the focus on a number, by its key.
    FocusSetting(&'static str),
    /// The focus has reached this step of its way to a number.
    SettingFocused(SettingFocus),
    /// Sets if the window asks before it closes with an unsaved session.
    AskBeforeClosing(bool),
    /// Closes the window without a question.
    Close,
    Copy(String),
    /// Draws a picture of a pane, and saves or copies it.
    TakePicture(PictureOrder, PictureTo),
    /// Copies a pane as it is in the window.
    CopyPicture(Pane),
    DismissToast(u64),
    /// Restarts a toast's lifetime while the pointer is on it.
    HoldToast(u64),
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
