//! The command line: one file for each subcommand. Nothing below this module prints.

mod ablate;
mod calibrate;
mod check;
mod choice;
mod compare;
mod completions;
mod desktop;
mod evaluate;
mod explain;
mod export;
mod failure;
mod judging_args;
mod licences;
mod live;
mod loading;
mod number_flags;
mod output;
mod plan;
mod printing;
mod program;
mod progress_line;
mod remedy_flags;
mod report;
mod schema;
mod screenshot;
mod settings_args;
mod simulate;
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
