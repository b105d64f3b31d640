//! Sense checks: whether what was read has the right sense, numbers and units.
//!
//! A drive's distances fit as well with every azimuth reversed, and on a rig with three like sides with stations exchanged:
//! the answer is then a mirror image, and no residual shows it. What shows it is which way round the prisms lie, how high
//! they stand, and the control points. Where one of them contradicts the answer, [`explanation`] looks for the one mistake
//! that would make all of them agree.

mod check;
mod explanation;
mod misreading;
mod shown;

pub use check::check;
pub use explanation::{Tried, explain_no_triplets};
