//! Coordinates and rigid transforms, the basis of every other module.
//!
//! This module does not depend on deployments.

mod alignment;
mod geodetic;
mod level_transform;
mod polar;
mod rigid_transform;
mod units;

pub use alignment::{align_level, align_rigid, align_similar, align_weighted};
pub use geodetic::Geodetic;
pub use level_transform::LevelTransform;
pub use polar::{LONGEST_RANGE_M, Polar, wrap_to_pi};
pub use rigid_transform::RigidTransform;
pub use units::{ARCSECOND_RAD, ARCSECONDS_PER_RAD, FOOT_M, US_SURVEY_FOOT_M};
