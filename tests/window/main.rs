//! The window, driven by the names of its widgets and compared with pictures.

#[path = "../common/mod.rs"]
mod common;

mod accessibility;
mod advice;
mod asking;
mod channels;
mod clocks;
mod corrections;
mod drives;
mod evaluation;
mod guide;
mod harness;
mod live;
mod messages;
mod naming;
mod networks;
mod numbers;
mod opening;
mod panes;
mod pictures;
mod planning;
mod playback;
mod plots;
mod results;
mod scene;
mod scene_legend;
mod scene_view;
mod screenshots;
mod sessions;
mod side_by_side;
mod trajectory;
mod validation;
mod workspace;
