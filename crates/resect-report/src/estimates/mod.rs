//! Estimates compared with a ground truth, as plain text, JSON, CSV, LaTeX and a picture.

mod chart;
mod csv;
mod json;
mod latex;
mod rows;
mod text;
mod verdicts;

pub use chart::draw;
pub use csv::csv;
pub use json::json;
pub use latex::latex;
pub use rows::{Angles, EMPTY, rows, why_empty};
pub use text::{agreed, contradiction, text, truth_in_words};
pub use verdicts::{PairTable, VERDICTS_IN_WORDS, VerdictRow, compared, error_in_words, verdicts};
