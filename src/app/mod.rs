//! The window.
//!
//! [`state`] holds everything and changes it in one place, [`worker`] computes beside it, [`layout`] arranges the
//! panes, and each pane is a function in [`panels`], [`plots`] or [`scene`] that reads the state and sends
//! commands.

mod actions;
pub mod file_dialog;
mod jobs;
pub mod keeping;
mod layout;
mod model;
mod panels;
pub mod persist;
mod plots;
mod prepared;
mod scene;
mod state;
mod theme;
mod window;

pub use layout::Layout;
pub use model::{
    AngleUnit, Asked, AskedAnswer, Colouring, Command, LayoutDescription, LayoutPreset, LengthUnit,
    OpenDeployment, Overlay, Pane, Picked, PictureTo, Pin, Playback, Results, Ruler, RulerEnd, Run,
    StudyKind, StudyOptions, StudyResult, Timeline, Units, ViewPreset, Visibility, toasts,
};
pub use scene::SceneView;
pub use state::State;
pub use window::{ResectWindow, Start, offscreen_renderer, open_window, picture};
