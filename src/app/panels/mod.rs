//! Panes that are lists of widgets: each is a function that reads the state and sends commands.

pub mod asked;
pub mod closing;
pub mod command_palette;
pub mod control_points;
pub mod corrections;
pub mod correlations;
pub mod deployment;
pub mod drop_hint;
pub mod empty_state;
pub mod evaluation;
mod extrinsics;
pub mod findings;
pub mod glossary;
pub mod guide;
mod judging_options;
pub mod licences;
pub mod live;
pub mod minima;
mod number;
pub mod observability;
pub mod path_prompt;
pub mod picture;
pub mod pipeline;
pub mod plan;
pub mod progress;
pub mod reading;
pub mod result;
pub mod runs;
pub mod shortcuts;
pub mod side_by_side;
pub mod solver;
pub mod studies;
pub mod time_bar;
pub mod toasts;
pub mod top_bar;
pub mod validation;
mod widgets;

use widgets::{
    MARGIN, SHORTEST_WAIT, fewer_or_more, finding, heading, number_cell, number_head, remedies_of,
    right_aligned, scrolled, use_pinned,
};
