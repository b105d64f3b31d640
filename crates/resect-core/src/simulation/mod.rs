//! Deployments with known truth, made from a preset and a seed; the same seed gives the same bytes.
//!
//! [`scenario`] describes the drive, [`motion`] moves the vehicle over the ground, [`instrument`] simulates the readings of the
//! stations and [`gnss`] those of the antennas. `resect_io::simulation_files` writes the readings as the files of a real deployment.
//! What instruments get wrong beyond noise is in [`errors`], and how large that is in the field in [`field_errors`].

mod deployment;
mod error_kind;
mod errors;
mod field_errors;
mod follow;
mod gnss;
mod ground;
mod instrument;
mod motion;
mod planar;
mod random;
mod scenario;
mod simulate;
mod simulated;
#[cfg(test)]
mod tests;

pub use error_kind::ErrorKind;
pub use errors::{ClockStep, Curvature, Settling, SystematicErrors, Wander};
pub use field_errors::draw;
pub use ground::{Ground, Ramp};
pub use motion::Motion;
pub use scenario::{Noise, Path, Preset, Scenario, Waypoint};
pub use simulate::{simulate, simulate_scenario};
pub use simulated::{EPOCH_S, Simulated, Truth};
