//! Estimates compared with a deployment's trajectory, as plain text, JSON, CSV and a picture.

mod chart;
mod csv;
mod json;
mod text;

pub use chart::draw;
pub use csv::csv;
pub use json::json;
pub use text::{Angles, compared, contradiction, rows, text};
