//! Validation of a calibration by another run of the same set-up.
//!
//! The run has a calibration of its own, independent of the earlier one. [`moved`] tests the difference for a move of a
//! station and finds that station. [`metric`] evaluates the inter-prism distances with the earlier calibration.
//! [`in_words`] formats the result. [`one_frame`] aligns runs whose stations were set up anew.
//!
//! **Covariance of the difference.** It is the sum of the covariances of both calibrations and of the settling of every
//! tripod in between. That settling is assumed as large as during a drive
//! ([`ErrorSizes::settling_m`](resect_core::calibration::ErrorSizes), `settling_rad`). Errors common to both runs (prisms, rig,
//! the same instruments) are counted twice although they partly cancel. The tests are therefore conservative, most of all
//! in height, where the rig's distances dominate.
//!
//! **Tests** of the whole difference, of a move of each station alone, and of the metric, each at the same significance level
//! ([`level`] of all together, Bonferroni). With three stations they reject a valid calibration at most once in a hundred runs.

mod earlier;
pub mod in_words;
pub mod metric;
pub mod moved;
pub mod one_frame;
mod outcome;
mod validate;

pub use self::earlier::Earlier;
pub use self::metric::MetricThere;
pub use self::moved::{Difference, StationMove};
pub use self::outcome::{Cause, Outcome, level};
pub use self::validate::{Validation, drive_alone, validate};
