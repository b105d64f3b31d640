//! Calibrations and trajectories for people and for other programs: text, JSON, CSV, HTML, pictures, bags, Rerun.
//!
//! # Modules, from the ground up
//! A module imports only from those above it in this table (`tests/structure`).
//!
//! | module | content | next change |
//! |---|---|---|
//! | [`font`], [`glossary`] | the one font; the terms of the field, explained | a term: a line in `glossary/terms.rs` |
//! | [`drawing`], [`axis`], [`frame`] | charts as one [`drawing::Drawing`], painted as SVG or by the window; their axes | |
//! | [`svg`] | a drawing as SVG and PNG | |
//! | [`box_chart`], [`residual_chart`], [`plan_view`] | the charts | |
//! | [`rows`], [`summary`], [`csv`], [`arrow`] | the rows of an answer as text; an answer as a summary, and as tables | a table: a function in `csv.rs` |
//! | [`of_run`], [`difference`] | the date and the durations of a run; the difference of two answers | |
//! | [`text`], [`trace`] | an answer in the terminal; the trace of the solver, as text and JSON | a column of the trace: `trace.rs` |
//! | [`json`] | `calibrate --json` and its reader | a field: `json.rs`, read again by `json/earlier.rs` |
//! | [`named_transform`], [`copy`] | transforms as text for other programs; an answer for the clipboard | a format: `named_transform.rs` |
//! | [`trajectory`] | TUM, CSV, PLY, bags | a new export of a trajectory: a file here, a variant of its `FileKind` |
//! | [`estimates`], [`extrinsics`], [`live`], [`planning`], [`study`], [`validation`] | the output of the commands `evaluate`, `extrinsics`, `live`, `plan`, of the studies (`compare`, `ablate`, `sweep`), of `validate` | |
//! | [`report`] | the HTML report | a section: a file here |
//! | [`rerun_error`], [`rerun`] | recordings for the Rerun viewer | |

pub mod arrow;
mod axis;
pub mod box_chart;
pub mod copy;
pub mod csv;
pub mod difference;
pub mod drawing;
pub mod estimates;
pub mod extrinsics;
pub mod font;
mod frame;
pub mod glossary;
pub mod json;
pub mod live;
pub mod named_transform;
pub mod of_run;
pub mod plan_view;
pub mod planning;
pub mod report;
#[cfg_attr(not(feature = "rerun"), path = "rerun_missing.rs")]
pub mod rerun;
pub mod rerun_error;
pub mod residual_chart;
pub mod rows;
pub mod study;
pub mod summary;
pub mod svg;
pub mod text;
pub mod trace;
pub mod trajectory;
pub mod validation;
