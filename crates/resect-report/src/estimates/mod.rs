//! Estimates compared with a ground truth, as plain text, JSON, CSV, LaTeX and pictures.

mod chart;
mod csv;
mod drives;
mod json;
mod latex;
mod map;
mod rows;
mod text;
mod trajectory_check;
mod verdict_sentence;
mod verdicts;

pub use chart::draw;
pub use csv::csv;
pub use drives::{DriveErrors, drives_csv, drives_json, drives_latex, drives_study, drives_text};
pub use json::json;
pub use latex::latex;
pub use map::draw_map;
pub use rows::{Angles, EMPTY, rows, why_empty};
pub use text::{agreed, contradiction, text, truth_in_words};
pub use trajectory_check::{trajectories_json, trajectory_text};
pub use verdict_sentence::{ADD_A_TRUTH, trajectory_in_words, verdict_sentence};
pub use verdicts::{PairTable, VERDICTS_IN_WORDS, VerdictRow, compared, error_in_words, verdicts};
