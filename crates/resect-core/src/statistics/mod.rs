//! Statistics that all modules share, one definition of each, with its source.
//!
//! Here are medians, quantiles and robust spreads. [`robust`] has loss functions, [`sandwich`] the covariance of an estimate
//! from data that is correlated in time, with and without a prior, and [`tables`] the quantiles of distributions.

pub mod estimate;
mod order;
pub mod robust;
pub mod sandwich;
pub mod tables;

pub use order::{central_sigma, median, quantile_of_sorted, quantiles, sigma_of_errors};
