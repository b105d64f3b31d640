//! Re-export of [`crate::statistics::estimate`].

pub use crate::statistics::estimate::{Estimate, Quantity, SUPPORTED_SIGMAS};
