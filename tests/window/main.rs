//! The window, driven by the names of its widgets and compared with pictures: one binary, because linking it takes
//! longer than most of its tests.

#[path = "../common/mod.rs"]
mod common;

mod asking;
mod clocks;
mod drives;
mod harness;
mod naming;
mod opening;
mod panes;
mod plots;
mod put_right;
mod results;
mod scene;
mod scene_legend;
mod scene_view;
mod screenshots;
mod sessions;
mod validation;
mod workspace;
