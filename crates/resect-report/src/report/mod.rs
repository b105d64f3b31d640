//! A report as one HTML page, for a client or an archive: no scripts, no requests, prints on A4.
//!
//! The same input gives the same bytes: the date is a parameter, and there are no durations.

mod answer;
mod charts;
mod correlation;
mod findings;
mod input;
mod joint;
mod judged;
mod page;
mod reliability;

pub use page::{Chapter, EvaluationChapter, page};
