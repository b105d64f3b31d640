//! Statistics that all modules share, one definition of each, with its source.
//!
//! This module has medians, quantiles and robust estimates of spread. [`robust`] has loss functions. [`sandwich`] computes the
//! covariance of an estimate from data that is correlated in time, with or without a prior. [`tables`] has quantiles of
//! distributions.

pub mod estimate;
mod order;
pub mod robust;
pub mod sandwich;
pub mod tables;

pub use order::{central_sigma, median, quantile_of_sorted, quantiles, sigma_of_errors};
