//! Estimates compared with a ground truth, as plain text, JSON, CSV, LaTeX and a picture.

mod chart;
mod csv;
mod json;
mod latex;
mod rows;
mod text;
mod verdict_sentence;
mod verdicts;

pub use chart::draw;
pub use csv::csv;
pub use json::json;
pub use latex::latex;
pub use rows::{Angles, EMPTY, rows, why_empty};
pub use text::{agreed, contradiction, text, truth_in_words};
pub use verdict_sentence::{ADD_A_TRUTH, trajectory_in_words, verdict_sentence};
pub use verdicts::{PairTable, VERDICTS_IN_WORDS, VerdictRow, compared, error_in_words, verdicts};
