//! Module 4: the positions of the stations' prisms at common instants.
//!
//! [`linear`] is the published method. [`squared_exponential`] and [`white_noise_on_acceleration`] estimate their
//! hyper-parameters, noise included, and give the standard deviation of each position.

mod allowance;
mod dense;
mod interpolate;
mod kernel;
pub mod linear;
mod minimise;
mod series;
pub mod squared_exponential;
#[cfg(test)]
mod tests;
pub mod white_noise_on_acceleration;

pub use interpolate::{grid, interpolate};
pub use series::InterpolatedTrack;
