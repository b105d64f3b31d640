//! The command line: one file for each subcommand. Nothing below this module prints.

mod ablate;
mod calibrate;
mod check;
mod choice;
mod compare;
mod comparison_args;
mod completions;
#[cfg(windows)]
mod console;
mod desktop;
#[cfg(target_os = "linux")]
mod desktop_entry;
mod drives;
mod evaluate;
mod explain;
mod export;
mod extrinsics;
mod failure;
mod frame_times;
mod judging_args;
mod licences;
mod live;
mod loading;
mod number_flags;
mod output;
mod picture_file;
mod plan;
mod printing;
mod program;
mod progress_line;
#[cfg(any(windows, test))]
mod registry_file;
mod remedy_flags;
mod report;
mod schema;
mod screenshot;
mod settings_args;
mod simulate;
#[cfg(windows)]
mod start_menu;
mod study_args;
mod sweep;
mod trajectory;
mod truth_args;
mod validate;
mod window;

pub use program::{arguments, run};

use failure::Failure;
use loading::{load, load_each};
use printing::{complain, note, print};
