//! Whether a calibration holds for another run of the same set-up.
//!
//! The run has an answer of its own, which knows nothing of the earlier one. [`moved`] asks of the difference whether a
//! station was moved or turned since, and which; [`metric`] asks what the earlier answer does to the prisms' distances
//! there; [`in_words`] tells it. [`one_frame`] brings runs together where stations were set up anew.
//!
//! **What the difference may be.** Its covariance is that of the earlier answer, that of the own one, and what every tripod
//! settles in between, which is taken to be once more what it settles during a drive
//! ([`ErrorSizes::settling_m`](crate::calibration::ErrorSizes), `settling_rad`). Errors that both runs have in common
//! (prisms, rig, the same instruments) are counted twice although they partly cancel: the tests are conservative, and most
//! so in height, where the rig's distances dominate.
//!
//! **Five tests**, each at a fifth of [`LEVEL`] (Bonferroni): the whole difference, a move of each station alone, and the
//! metric. Together they reject a calibration that holds once in a hundred runs, or less.

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
pub use self::outcome::{Cause, LEVEL, Outcome};
pub use self::validate::{Validation, drive_alone, validate};
