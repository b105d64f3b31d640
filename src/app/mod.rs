//! The window.
//!
//! Panes read the [`State`] and send [`Command`]s, which change it between frames; only the layout and the view, which egui
//! moves while it draws, change within one. Every arrow goes down:
//!
//! ```text
//! window                      one frame; how it opens; how it becomes a picture
//! ├─ panels                   panes of text and controls, bars, dialogs
//! │  └─ actions               menus, palette and keys: which command, when it is possible
//! ├─ keeping                  what a running window keeps for the next one
//! ├─ scene, plots             panes that are drawn
//! └─ state                    everything, and the one place where it changes
//!    ├─ persist               sessions, preferences, autosave: as files
//!    ├─ layout                where the panes are
//!    └─ model                 plain data: commands, what is open, timeline, undo, units, toasts, view
//!       ├─ prepared           what is computed for drawing, and the thread that does it
//!       ├─ jobs               work beside the window, whose outcome is a function applied to the state
//!       └─ file_dialog, theme, words   asking for a path; colours and sizes; words explained where they stand
//! ```
//!
//! `panels` draws on `plots` too, where a study is a chart, and any room may take from `theme` and `words`.
//! `tests/structure.rs` holds the order of these rooms against the imports.
//!
//! | what is new | where it goes |
//! |---|---|
//! | something that can be done | a variant of `model/command.rs`, an arm in `state/handle.rs`, a line with its key in `actions/`, which has a file a menu |
//! | a setting of the scene | a field of `model/scene_options.rs`; sessions keep it whole (`persist/session.rs`) |
//! | work that takes long | `self.jobs.start(work, take)` in `state/`; what goes on puts into `jobs.outbox()`; `jobs.rs` itself knows no job |
//! | a button for what a finding advises | a variant of `deployment::Remedy`, an arm in `actions/remedies.rs` |

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
mod words;

pub use layout::Layout;
pub use model::{
    AngleUnit, Asked, AskedAnswer, Camera, Colouring, Command, LayoutDescription, LayoutPreset,
    LengthUnit, OpenDeployment, Overlay, Pane, Picked, PictureTo, Pin, Playback, Plotted, Results,
    Ruler, RulerEnd, Run, SceneOptions, StudyKind, StudyOptions, StudyResult, TimeUnit, Timeline,
    Units, ViewPreset, Visibility, toasts,
};
pub use prepared::channels::Channel;
pub use scene::SceneView;
pub use state::State;
pub use window::{ResectWindow, Start, offscreen_renderer, open_window, picture};
