//! Answers for other programs and for people: JSON, text, CSV, and recordings for the Rerun viewer.

pub mod csv;
pub mod json;
#[cfg(feature = "rerun")]
pub mod rerun;
pub mod text;
