//! One-step estimate of the station clocks beside an answer of method D, to detect clock offsets that bias it.
//!
//! One Gauss–Newton step of the distance residuals from the answer ([`mod@check`]). The state vector has transforms, clock
//! offsets, jumps, distances and the prism constant ([`model`]). Huber weights and the noise model ([`noise`]) enter the
//! sums by blocks of time ([`sums`]), and the sandwich gives the covariance ([`mod@covariance`]).

mod check;
mod covariance;
mod model;
mod noise;
mod sums;

pub use check::suspected_clocks;
