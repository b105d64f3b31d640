//! A report as one HTML page, to hand to a client or to keep with a run: no scripts, nothing fetched, prints on A4.
//!
//! The same input gives the same bytes: the date is given, and no wall time is in it.

mod answer;
mod charts;
mod correlation;
mod findings;
mod input;
mod joint;
mod judged;
mod page;

pub use page::{Chapter, page};
