//! Sense checks: detection of wrong sense of azimuths, station numbers and units.
//!
//! A drive's distances fit as well with every azimuth reversed. On a rig with three equal sides they also fit with stations
//! exchanged. The answer is then a mirror image, and no residual shows it. Orientation and heights of the prisms, and the control
//! points, show it. If one of them contradicts the answer, [`explanation`] looks for the single mistake that would make all of them
//! agree.

mod check;
mod explanation;
mod misreading;
mod shown;

pub use check::check;
pub use explanation::{Tried, explain_no_triplets};
