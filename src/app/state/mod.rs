//! State of the window. Only this module changes it.

mod advice;
mod asked;
mod asking;
mod channels_csv;
pub mod corrections;
mod deployment_toml;
mod deployments;
mod dialogs;
mod evaluation_files;
mod handle_deployment;
mod handle_dialog;
mod handle_scene;
mod handle_time;
mod handle_workspace;
mod hovering;
mod judging;
mod live;
mod naming;
mod opening;
mod outcomes;
mod picture;
mod planning;
mod restoring;
mod results;
mod saving;
mod scene_state;
mod session_state;
mod sessions;
mod studies;
mod time_state;
mod validating;
mod window_state;
mod workspace;

pub use session_state::SessionState;
pub use window_state::State;
