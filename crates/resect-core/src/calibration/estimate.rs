//! A number with its uncertainty: see [`crate::statistics`].

pub use crate::statistics::estimate::{Estimate, Quantity, SUPPORTED_SIGMAS};
