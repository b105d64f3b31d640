//! Findings of this crate: one constructor for each kind, with its message.

pub mod conventions;
mod examples;
pub mod kinds;
pub mod planning;
pub mod studies;
pub mod validation;

pub use examples::examples;
