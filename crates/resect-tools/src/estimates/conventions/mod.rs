//! Stated conventions of an estimate's file, as words and as their effect on its poses.
//!
//! [`super::convention_checks`] finds the conventions that the data suggests.

mod convention;
mod convention_words;
mod left_out_poses;
mod signed_axes;

pub use convention::{AngleConvention, Convention, Inverted};
pub use convention_words::{WORDS, orientation_in_words};
pub use left_out_poses::{HeldPart, is_unset};
pub use signed_axes::SignedAxes;
