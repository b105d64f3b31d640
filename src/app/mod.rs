//! The window.
//!
//! Panes read the [`State`] and send [`Command`]s, which change it between frames; only the layout and the view, which egui
//! moves while it draws, change within a frame. A room imports only from rooms drawn below it, and not from its neighbours:
//!
//! ```text
//! picture                     the window as a picture, drawn off the screen
//! └ window                    one frame; how it opens
//! ├─ panels                   panes of text and controls, bars, dialogs, toasts
//! │  └─ actions               menus, palette and keys: which command, when it is possible
//! ├─ keeping                  when a running window writes its preferences and its session, for the case that it dies
//! ├─ scene, plots             panes that are drawn: the lines that are seen, from series made in `prepared`
//! └─ state                    everything by its parts, and the one place where it changes
//!    ├─ persist               what is in the files of sessions, preferences, autosave, and how they are read again
//!    ├─ layout                where the panes are
//!    └─ model                 plain data: commands, what is open, timeline, undo, units, toasts, view
//!       ├─ prepared           what is computed for drawing, statistics along the drive (`running.rs`) included; the thread
//!       │                     that calibrates while a slider moves (`analyser.rs`)
//!       ├─ jobs               other work beside the window, whose outcome is a function applied to the state
//!       └─ file_dialog, theme, words, short   asking for a path; colours and sizes of the window itself, dark and light (those
//!                             that mean something are in `resect_core::palette`); words explained on hover, where a label asks; names
//!                             made short
//! ```
//!
//! The state has parts, each with its commands in `model/command.rs` and a handler in `state/`:
//!
//! | part | data | commands, handler |
//! |---|---|---|
//! | open deployments, undo | `state/deployments.rs`, `model/open_deployment.rs` | `DeploymentCommand`, `handle_deployment.rs` |
//! | time: cursor, selection, playback, plotted values | `state/time_state.rs`, `model/timeline.rs` | `TimeCommand`, `handle_time.rs` |
//! | scene: camera, visibility, colouring, options | `state/scene_state.rs` | `SceneCommand`, `handle_scene.rs` |
//! | results: runs, pins, studies, validation | `model/results.rs` | `ResultsCommand`, `results.rs` |
//! | judging of trajectories | `model/judging.rs`, by deployment | `JudgingCommand`, `judging.rs` |
//! | planning | `model/planning.rs` | `PlanCommand`, `planning.rs` |
//! | live deployment | `model/live.rs` | `LiveCommand`, `live.rs` |
//! | session | `state/session_state.rs` | `SessionCommand`, `sessions.rs` |
//! | dialogs, questions, sheets | `state/dialogs.rs` | `DialogCommand`, `handle_dialog.rs` |
//! | workspace: layout, units, colours, toasts | `state/workspace.rs`, `model/toasts.rs` | `WorkspaceCommand`, `handle_workspace.rs` |
//!
//! `panels` draws on `plots` too, where a study is a chart, and any room may take from `theme`, `words` and `short`.
//! `tests/structure.rs` holds the order of these rooms against the imports.
//!
//! | what is new | where it goes |
//! |---|---|
//! | something that can be done | a variant of its part's commands in `model/command.rs`, an arm in the handler of that part in `state/`, a line with its key in `actions/`: `file.rs`, `edit.rs`, `time.rs` (the cursor, what is selected) and `view.rs`, `help.rs` |
//! | where plots over time lie and how high they are | `plots/strips.rs`, for all panes alike |
//! | a setting of the scene | a field of `model/scene_options.rs`; sessions keep it whole (`persist/session.rs`) |
//! | a colouring of the points | a variant of `model/colouring.rs`, its colours in `scene/colouring.rs`, its legend in `scene/legend_rows.rs` |
//! | a key that only one pane has | that pane: `plots/navigation.rs`, `scene/input.rs` |
//! | work that takes long | `self.jobs.start(work, take)` in `state/`: `take` gets what `work` returned, and the state; work with news before its end puts functions into `jobs.outbox()` |
//! | something that a session remembers | a field of `persist/session.rs`, with what an older file without it means; filled and restored in `state/sessions.rs`; how deployments and pins lie in the file: `persist/stored.rs` |
//! | a handle of a plan, or a number of it | a variant of `Handle` in `model/planning.rs`, drawn in `plots/plan_map.rs`; a field in `panels/plan/numbers.rs` |
//! | something told of a live drive that is no warning | a field of `resect_live::View`, a line in `panels/live.rs`, and in `resect_report::live` for robots |
//! | a button for what a finding advises | a variant of `deployment::Remedy`, an arm in `actions/remedies.rs` |

pub mod actions;
pub mod file_dialog;
mod jobs;
pub mod keeping;
mod layout;
mod model;
mod panels;
pub mod persist;
mod picture;
mod plots;
mod prepared;
mod scene;
mod short;
mod state;
mod theme;
mod window;
mod words;

pub use layout::Layout;
pub use model::{
    AngleUnit, Asked, AskedAnswer, Camera, ChannelPlots, Colouring, Command, DeploymentCommand,
    DialogCommand, JudgingCommand, LayoutDescription, LayoutPreset, LengthUnit, LiveCommand,
    LiveForm, OpenDeployment, Overlay, Pane, Picked, PictureTo, Pin, PlanCommand, Playback,
    Results, ResultsCommand, Ruler, RulerEnd, Run, SceneCommand, SceneOptions, SessionCommand,
    StudyKind, StudyOptions, StudyResult, TimeCommand, TimeUnit, Timeline, Units, ViewPreset,
    Visibility, WorkspaceCommand, toasts,
};
pub use picture::{offscreen_renderer, picture};
pub use prepared::channels::Channel;
pub use scene::SceneView;
pub use state::State;
pub use window::{ResectWindow, Start, open_window};
