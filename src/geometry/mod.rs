//! Coordinates and rigid motions: the vocabulary that every other module shares.
//!
//! Nothing here knows what a deployment is.

mod alignment;
mod level_transform;
mod polar;

pub use alignment::align_level;
pub use level_transform::LevelTransform;
pub use polar::{Polar, wrap_to_pi};
