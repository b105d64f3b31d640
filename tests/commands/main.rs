//! The commands and their output: text, JSON, reports, trajectories, studies, validations and live deployments.
//!
//! Tests with `peer` in their name compare with programs from PyPI; they are ignored here, and `tests/run --peers` runs them.

#[path = "../common/mod.rs"]
mod common;

mod book;
mod commands;
mod conventions;
mod evaluate;
mod golden;
mod ground_truths;
mod live;
mod networks;
mod opened_paths;
mod public_truths;
mod report;
mod report_evaluation;
mod schema;
mod schema_check;
mod studies;
mod trajectory;
mod validation;
