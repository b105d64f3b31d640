//! Everything that can be asked for. Panes send these; [`super::State::handle`] carries them out.

use std::path::PathBuf;

use super::Units;
use super::studies::StudyOptions;
use super::{Added, Asked, AskedAnswer, Lookup, Palette, Picked, Plotted, Visibility};
use super::{Colouring, Ruler, SceneOptions, ViewPreset};
use super::{LayoutPreset, LiveCommand, Pane, PlanCommand, WayPlots};
use crate::app::file_dialog::PromptCommand;
use resect_core::analysis::Settings;
use resect_io::sample::Sample;
use resect_io::source::{Extras, Source};
use resect_report::copy::{CopyFormat, Part};

/// What a pane asks for.
#[derive(Clone, Debug)]
pub enum Command {
    /// Opens whatever the readers know: tracks, folders, control points, a rig, GNSS, settings, sessions.
    OpenPaths(Vec<PathBuf>),
    OpenSample(Sample),
    /// Opens what was open before.
    OpenSource(Source),
    /// Stops reading a deployment, by its request's number.
    CancelOpening(u64),
    OpenFolderDialog,
    OpenFileDialog,
    /// Something was done in the prompt for a path.
    Prompt(PromptCommand),
    OpenSessionDialog,
    /// Closes what was restored after a crash.
    DiscardRecovered,
    /// What was open before a session took its place, or before the last window was closed.
    ReopenLast,
    /// Files hover over the window.
    HoverPaths(Vec<PathBuf>),
    /// Into its file, which is asked for the first time.
    SaveSession,
    SaveSessionAs,
    /// Opens again what the session holds and could not be opened.
    RetryMissing,
    /// Takes a deployment that could not be opened out of the session, by its place among those.
    ForgetMissing(usize),
    /// Shows another of the open deployments, by its id.
    Activate(u64),
    Close(u64),

    /// Sets the settings of the active deployment.
    Set(Settings),
    /// Gives every open deployment the active one's settings.
    SetAll,
    /// Stops calibrating a deployment, by its id, and goes back to the settings of the answer that is shown.
    CancelAnalysis(u64),
    Undo,
    Redo,

    /// Reads the active deployment again with these beside its tracks, as a step that can be undone.
    PutRight(Extras),
    /// Unfolds what can be put right, in its pane.
    ShowPutRight,
    ChooseRigDialog,
    AddControlPointsDialog,
    /// Asks whether what is put right goes into the folder's `deployment.toml`.
    WriteDeploymentToml,
    /// Something was chosen in what the window asks.
    EditAsked(Asked),
    AnswerAsked(AskedAnswer),
    CancelAsked,

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
    /// Brings a control point before the camera.
    LookAtPoint {
        file: String,
        marker: i64,
    },

    /// Plots a channel in the pane of channels.
    Plot(Plotted),
    Show(Visibility),
    Colour(Colouring),
    SetScene(SceneOptions),
    Measure(Ruler),
    SetUnits(Units),
    UseTheme(egui::ThemePreference),
    /// Large type and full contrast, to be read in the sun.
    ReadInTheSun(bool),
    Look(ViewPreset),
    /// The camera glides to a place (m, in station 1's frame).
    ComeTo(nalgebra::Vector3<f64>),
    ScenePicture(PictureTo),

    Copy(String),
    /// Copies transforms of the active deployment's answer.
    CopyTransforms(CopyFormat, Part),
    OpenInRerun,
    SaveRecordingDialog,
    SaveTrajectoryDialog,
    SaveReportDialog,
    /// Every value of what the pane of channels shows.
    SaveChannelsDialog,

    /// Reads trajectories of other systems and holds them against the active deployment.
    AddEstimates(Vec<PathBuf>),
    AddEstimateDialog,
    /// The trajectories that are held against the active deployment, and how each is.
    Judge(Vec<Added>),
    /// Chooses what the pane of the trajectory plots.
    PlotWay(WayPlots),

    /// Something about the plan.
    Plan(PlanCommand),
    /// Something about the live deployment.
    Live(LiveCommand),

    /// Holds the active deployment's calibration against the others that are open.
    ValidateOthers,

    SetStudy(StudyOptions),
    RunStudy,
    CancelStudy,
    SaveStudyDialog,

    /// Brings a pane to the front.
    ShowPane(Pane),
    UseLayout(LayoutPreset),
    ResetLayout,
    ShowPalette,
    /// What is typed in the command palette and which of its lines is chosen.
    EditPalette(Palette),
    ShowShortcuts,
    /// Explains the word under the pointer or with the focus; all words where there is none.
    Explain,
    /// What is typed among the words of the field.
    LookUp(Lookup),
    /// Closes the palette, the sheet of shortcuts or the glossary.
    CloseOverlay,
    DismissToast(u64),
    /// The pointer is on a toast.
    HoldToast(u64),
}

pub type Commands = Vec<Command>;

/// Where a picture of the scene goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureTo {
    File,
    Clipboard,
}
