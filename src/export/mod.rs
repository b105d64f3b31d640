//! Answers for other programs and for people: JSON, text, CSV, HTML, pictures, and recordings for the Rerun viewer.

mod axis;
pub mod box_chart;
pub mod copy;
pub mod csv;
pub mod difference;
pub mod drawing;
pub mod estimates;
mod frame;
pub mod json;
pub mod live;
pub mod of_run;
pub mod plan_view;
pub mod planning;
pub mod report;
#[cfg_attr(not(feature = "rerun"), path = "rerun_missing.rs")]
pub mod rerun;
pub mod residual_chart;
pub mod study;
pub mod summary;
pub mod svg;
pub mod text;
pub mod trajectory;

pub mod validation;
