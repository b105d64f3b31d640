//! Findings of this crate: one constructor for each kind, with its message.

pub mod answers;
pub mod checks;
pub mod clocks;
pub mod drive;
mod examples;
pub mod instruments;
pub mod mirror;
pub mod outliers;
pub mod points;
pub mod recordings;

pub use examples::examples;
