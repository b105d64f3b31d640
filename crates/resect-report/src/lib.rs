//! Calibrations and trajectories for people and for other programs: text, JSON, CSV, HTML, pictures, bags, Rerun.
//!
//! | module | content | next change |
//! |---|---|---|
//! | [`glossary`], [`font`] | the terms of the field, explained; the one font | a term: a line in `glossary/terms.rs` |
//! | [`rows`], [`text`], [`summary`], [`csv`], [`copy`] | an answer in the terminal, as tables, for the clipboard | |
//! | [`json`] | `calibrate --json` and its reader | a field: `json.rs`, read again by `json/earlier.rs` |
//! | [`trajectory`] | TUM, CSV, PLY, bags | a new export of a trajectory: a file here, a variant of its `FileKind` |
//! | [`drawing`], [`svg`], [`box_chart`], [`residual_chart`], [`plan_view`] | charts as one [`drawing::Drawing`], painted as SVG or by the window | |
//! | [`report`] | the HTML report | a section: a file here |
//! | [`estimates`], [`live`], [`planning`], [`study`], [`validation`], [`difference`] | what the command of that name prints and writes | |
//! | [`rerun`] | recordings for the Rerun viewer | |

mod axis;
pub mod box_chart;
pub mod copy;
pub mod csv;
pub mod difference;
pub mod drawing;
pub mod estimates;
pub mod font;
mod frame;
pub mod glossary;
pub mod json;
pub mod live;
pub mod of_run;
pub mod plan_view;
pub mod planning;
pub mod report;
#[cfg_attr(not(feature = "rerun"), path = "rerun_missing.rs")]
pub mod rerun;
pub mod residual_chart;
pub mod rows;
pub mod study;
pub mod summary;
pub mod svg;
pub mod text;
pub mod trajectory;
pub mod validation;
