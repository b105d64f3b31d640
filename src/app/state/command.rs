//! Everything that can be asked for. Panes send these; [`super::State::handle`] carries them out.

use std::path::PathBuf;

use super::{Picked, Visibility};
use crate::analysis::Settings;
use crate::app::layout::Pane;
use crate::app::scene::{Colouring, Ruler, ViewPreset};
use crate::app::studies::StudyOptions;
use crate::deployment::Sample;

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
    Undo,
    Redo,

    /// Time under the pointer (s, in the stations' clock); sent in every frame while it is there.
    Hover(f64),
    MoveCursor(f64),
    /// By triplets.
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

    Show(Visibility),
    Colour(Colouring),
    Measure(Ruler),
    Look(ViewPreset),
    ScenePicture(PictureTo),

    Copy(String),
    OpenInRerun,
    SaveRecordingDialog,
    SaveTrajectoryDialog,
    SaveReportDialog,

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

/// Where a picture of the scene goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureTo {
    File,
    Clipboard,
}
