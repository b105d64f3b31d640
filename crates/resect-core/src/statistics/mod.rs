//! The statistics that everything here shares: one definition of each, with where it comes from.
//!
//! Here are medians, quantiles, and the spreads that wild values leave alone; [`robust`] is what a large error counts;
//! [`sandwich`] the covariance of an estimate from data that is correlated in time, with and without prior knowledge.

pub mod estimate;
mod order;
pub mod robust;
pub mod sandwich;

pub use order::{central_sigma, median, quantile_of_sorted, quantiles, sigma_of_errors};
