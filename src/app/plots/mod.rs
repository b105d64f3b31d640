//! Plots: over time ([`residuals`], [`rates`], [`intervals`], [`clocks`], [`channels`], all through [`time_plot`]), and others.
//!
//! Data too expensive for a frame are in [`PreparedPlots`] and [`RawReadings`], computed by the worker. A frame draws long series as
//! reduced by their [`pyramid`].

mod axis_marks;
mod bands;
pub mod channels;
pub mod chart;
pub mod clocks;
mod dimension_units;
mod estimate_errors;
pub mod histogram;
pub mod intervals;
pub mod live_sigma;
mod log_axis;
mod marks;
mod navigation;
pub mod plan_map;
pub mod prior_search;
pub mod quads;
pub mod rates;
pub mod residuals;
mod shown_answer;
mod strips;
mod switches;
mod threshold;
mod time_plot;
mod times;

pub use axis_marks::{close_marks, round_marks};
pub use shown_answer::in_the_middle;
pub use strips::{axis_below, bare_axis};
pub use time_plot::still;

use axis_marks::{GRID, LABELS, per_point, with_room};
use shown_answer::{answer, answer_with_errors};
use switches::{pair_name, pair_switches, station_switches};
