//! Answers for other programs and for people: JSON, text, CSV, and recordings for the Rerun viewer.

pub mod csv;
pub mod json;
#[cfg_attr(not(feature = "rerun"), path = "rerun_missing.rs")]
pub mod rerun;
pub mod text;
