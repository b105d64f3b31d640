//! The graphical user interface.
//!
//! Panes read the [`State`] and send [`Command`]s, which change it between frames. Only the layout and the view change within a frame,
//! because egui moves them while it draws. A module imports only from modules below it in this diagram, and not from siblings:
//!
//! ```text
//! picture                     the window as an image, rendered off screen
//! └ window                    one frame; opening the window
//! ├─ panels                   panes of text and controls, bars, dialogs, toasts
//! │  └─ actions               menus, palette and keys: commands, and the conditions under which they are possible
//! ├─ saved_state              writes preferences and the session of a running window, for recovery after a crash
//! ├─ scene, plots             panes that are drawn, from series computed in `prepared`
//! └─ state                    the whole state, and the only place that changes it
//!    ├─ persist               files of sessions, preferences and autosave: format, reading and writing
//!    ├─ layout                arrangement of the panes
//!    ├─ pictures              a pane as PNG or SVG, drawn off screen
//!    └─ model                 plain data: commands, open deployments, timeline, undo, units, toasts, view
//!       ├─ prepared           data computed for drawing, including statistics along the drive (`running.rs`); the thread
//!       │                     that calibrates while a slider moves (`analyser.rs`)
//!       ├─ jobs               other background work; the outcome is a function applied to the state
//!       ├─ display_server     X11 where the Wayland server is dead
//!       └─ file_dialog, theme, words, short   asking for a path; dark and light colours and sizes of the window itself (data
//!                             colours are in `resect_tools::palette`); terms explained on hover and by F1; shortened
//!                             names
//! ```
//!
//! The state has these parts, each with its commands in `model/command.rs` and a handler in `state/`:
//!
//! | part | data | commands, handler |
//! |---|---|---|
//! | open deployments, undo | `state/deployments.rs`, `model/open_deployment.rs` | `DeploymentCommand`, `handle_deployment.rs` |
//! | time: cursor, selection, playback, plotted values | `state/time_state.rs`, `model/timeline.rs` | `TimeCommand`, `handle_time.rs` |
//! | scene: camera, visibility, colouring, options | `state/scene_state.rs` | `SceneCommand`, `handle_scene.rs` |
//! | results: runs, pins, studies, validation | `model/results.rs` | `ResultsCommand`, `results.rs` |
//! | evaluation of trajectories | `model/judging.rs`, by deployment | `JudgingCommand`, `judging.rs`; without a deployment: `evaluation_files.rs` |
//! | planning | `model/planning.rs` | `PlanCommand`, `planning.rs` |
//! | live deployment | `model/live.rs` | `LiveCommand`, `live.rs` |
//! | session | `state/session_state.rs` | `SessionCommand`, `sessions.rs` |
//! | dialogs, questions, sheets | `state/dialogs.rs` | `DialogCommand`, `handle_dialog.rs` |
//! | workspace: layout, units, colours, toasts | `state/workspace.rs`, `model/toasts.rs` | `WorkspaceCommand`, `handle_workspace.rs` |
//!
//! `panels` uses `plots` as well, for the charts of studies. Any module may import from `theme`, `words` and `short`. `tests/structure`
//! checks the imports against this order.
//!
//! | to add | edit |
//! |---|---|
//! | an action of the user | a variant of the part's commands in `model/command.rs`, an arm in the part's handler in `state/`, a line with its key in `actions/`: `file.rs`, `edit.rs`, `time.rs` (cursor, selection) and `view.rs`, `help.rs` |
//! | position and height of plots over time | `plots/strips.rs`, for all panes |
//! | a setting of the scene | a field of `model/scene_options.rs`; sessions save all of it (`persist/session.rs`) |
//! | a colouring of the points | a variant of `model/colouring.rs`, its colours in `scene/colouring.rs`, its legend in `scene/legend_rows.rs` |
//! | a key of a single pane | that pane: `plots/navigation.rs`, `scene/input.rs` |
//! | long-running work | `self.jobs.start(work, take)` in `state/`: `take` receives the result of `work`, and the state; work with intermediate results sends functions to `jobs.outbox()` |
//! | a value saved in sessions | a field of `persist/session.rs`, with a default for older files without it; filled and restored in `state/sessions.rs`; file format of deployments and pins: `persist/stored.rs` |
//! | a handle or a number of a plan | a variant of `Handle` in `model/planning.rs`, drawn in `plots/plan_map.rs`; a field in `panels/plan/numbers.rs` |
//! | a message about a live drive other than a warning | a field of `resect_live::View`, a line in `panels/live.rs`, and in `resect_report::live` for robots |
//! | a button for the advice of a finding | a variant of `deployment::Remedy`, an arm in `actions/remedies.rs` |

pub mod actions;
#[cfg(target_os = "linux")]
mod display_server;
pub mod file_dialog;
mod jobs;
mod layout;
mod model;
mod panels;
pub mod persist;
mod picture;
mod pictures;
mod plots;
mod prepared;
pub mod saved_state;
mod scene;
mod short;
mod state;
mod theme;
mod window;
mod words;

pub use layout::Layout;
pub use model::{
    AngleUnit, Asked, AskedAnswer, Camera, ChannelPlots, Colouring, Command, DeploymentCommand,
    DialogCommand, Horizontal, JudgingCommand, LayoutDescription, LayoutPreset, LengthUnit,
    LiveCommand, LiveForm, OpenDeployment, Overlay, Pane, Picked, PictureFormat, PictureOrder,
    PictureTo, Pin, PlanCommand, Playback, Results, ResultsCommand, Ruler, RulerEnd, Run,
    SceneCommand, SceneOptions, SessionCommand, StudyKind, StudyOptions, StudyResult, TimeCommand,
    TimeUnit, Timeline, Units, ViewPreset, Visibility, WorkspaceCommand, kinds, toasts,
};
pub use picture::{ScreenshotOrder, offscreen_renderer, picture, without_graphics};
pub use pictures::pane_picture::PanePicture;
pub use prepared::channels::Channel;
pub use scene::SceneView;
pub use state::State;
pub use window::{ResectWindow, Start, open_window};
