//! Simulated deployments with known ground truth, from a preset and a seed; the same seed gives the same bytes.
//!
//! [`scenario`] describes the drive and [`preset`] has ready-made ones. [`motion`] moves the vehicle over the ground.
//! [`instrument`] simulates the readings of the stations and [`gnss`] those of the antennas. [`errors`] has the systematic
//! errors of instruments, [`facet_errors`] those of prisms, and [`field_errors`] their sizes in the field. `resect_io::simulation_files` writes the readings
//! as the files of a real deployment.

mod deployment;
mod error_kind;
mod errors;
mod facet_errors;
mod field_errors;
mod follow;
mod gnss;
mod ground;
mod instrument;
mod motion;
mod network;
mod planar;
mod preset;
mod random;
mod scenario;
mod simulate;
mod simulated;
#[cfg(test)]
mod tests;
mod waypoint;

pub use error_kind::ErrorKind;
pub use errors::{
    Centring, ChangedSetUp, ClockStep, Curvature, FurtherError, Settling, SystematicErrors, Wander,
};
pub use facet_errors::FacetErrors;
pub use field_errors::{draw, draw_facets};
pub use ground::{Ground, Ramp};
pub use motion::Motion;
pub use network::further_prism_m;
pub use preset::Preset;
pub use scenario::{Noise, Path, Scenario};
pub use simulate::{simulate, simulate_scenario};
pub use simulated::{EPOCH_S, Simulated, Truth};
pub use waypoint::Waypoint;
