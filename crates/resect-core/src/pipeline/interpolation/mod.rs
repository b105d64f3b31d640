//! Module 4: the positions of the three prisms at common instants.
//!
//! [`linear`] as published; [`squared_exponential`] and [`white_noise_on_acceleration`] learn their hyper-parameters,
//! noise included, and say how well each position is known.

mod allowance;
mod dense;
mod elimination;
mod interpolate;
mod kernel;
mod linear;
mod minimise;
mod series;
pub mod squared_exponential;
#[cfg(test)]
mod tests;
pub mod white_noise_on_acceleration;

pub use interpolate::interpolate;
pub use series::Estimate;
