//! The window.
//!
//! [`state`] holds everything and changes it in one place, [`worker`] computes beside it, [`layout`] arranges the
//! panes, and each pane is a function in [`panels`], [`plots`] or [`scene`] that reads the state and sends
//! commands.

mod actions;
mod ago;
pub mod file_dialog;
mod layout;
mod open_deployment;
mod panels;
pub mod persist;
mod plots;
mod scene;
mod state;
mod studies;
mod theme;
pub mod toasts;
mod units;
mod window;
mod worker;

pub use layout::{Layout, LayoutDescription, LayoutPreset, Pane};
pub use open_deployment::OpenDeployment;
pub use scene::{Colouring, Ruler, RulerEnd, SceneView, ViewPreset};
pub use state::{
    Asked, AskedAnswer, Command, Overlay, Picked, PictureTo, Pin, Playback, Results, Run, State,
    Timeline, Visibility,
};
pub use studies::{StudyKind, StudyOptions, StudyResult};
pub use units::{AngleUnit, LengthUnit, Units};
pub use window::{ResectWindow, Start, offscreen_renderer, open_window, picture};
