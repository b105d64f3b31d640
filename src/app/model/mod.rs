//! Data of the window. This module neither draws nor waits, and does not depend on its readers.
//!
//! Panes read it and send [`Command`]s; only [`super::state`] changes it.

pub mod ago;
mod asked;
mod background_value;
mod camera;
pub mod channel_plots;
mod colouring;
mod command;
pub mod estimates;
pub mod findings;
pub mod flight;
pub mod follow;
pub mod judging;
pub mod kinds;
pub mod layout_description;
pub mod layout_presets;
pub mod live;
pub mod new_findings;
mod open_deployment;
mod overlay;
pub mod pane;
mod picture_order;
pub mod planning;
pub mod results;
mod ruler;
mod scene_options;
pub mod studies;
pub mod time_scale;
pub mod timeline;
pub mod toasts;
pub mod undo;
pub mod units;
mod validations;
mod view;
mod visibility;

pub use asked::{
    Asked, AskedAnswer, AskedColumns, AskedFiles, AskedStations, AskedToml, AskedTracks,
    LEAST_FILES, StationsAre, TableHead,
};
pub use background_value::BackgroundValue;
pub use camera::{Camera, Frame, ViewPreset};
pub use channel_plots::{ChannelPlots, Horizontal};
pub use colouring::Colouring;
pub use command::{
    Command, Commands, DeploymentCommand, DialogCommand, JudgingCommand, ResultsCommand,
    SceneCommand, SessionCommand, SettingFocus, TimeCommand, WorkspaceCommand,
};
pub use judging::{Added, Judging, SavedEstimate};
pub use layout_description::LayoutDescription;
pub use layout_presets::LayoutPreset;
pub use live::{LiveCommand, LiveForm};
pub use open_deployment::{Analysing, OpenDeployment};
pub use overlay::{Lookup, Overlay, Palette};
pub use pane::Pane;
pub use picture_order::{PictureFormat, PictureOrder, PictureTo};
pub use planning::{PlanCommand, Planning};
pub use results::{Pin, Results, Run};
pub use ruler::{Ruler, RulerEnd};
pub use scene_options::SceneOptions;
pub use studies::{StudyKind, StudyOptions, StudyResult};
pub use time_scale::TimeScale;
pub use timeline::{Picked, Playback, Timeline};
pub use undo::UndoStack;
pub use units::{AngleUnit, LengthUnit, TimeUnit, Units};
pub use validations::{AnswerOf, Validated};
pub use view::{Look, View};
pub use visibility::Visibility;
