//! Answers for other programs and for people: JSON, text, CSV, and recordings for the Rerun viewer.

mod axis;
pub mod box_chart;
pub mod csv;
pub mod drawing;
pub mod json;
#[cfg_attr(not(feature = "rerun"), path = "rerun_missing.rs")]
pub mod rerun;
pub mod study;
pub mod svg;
pub mod text;
pub mod tum;
