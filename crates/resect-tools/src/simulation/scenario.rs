//! The description of a simulated drive: path, ground, instruments and their errors.

use nalgebra::Vector3;
use resect_core::network::{PerPrism, PerStation};

use super::error_kind::ErrorKind;
use super::errors::SystematicErrors;
use super::ground::Ground;
use super::waypoint::Waypoint;

/// The path of the vehicle, in the frame of station 1.
#[derive(Clone, Debug, PartialEq)]
pub enum Path {
    /// A winding path about a centre (m), which turns back at a radius (m).
    Wander { centre_m: [f64; 2], radius_m: f64 },
    /// Back and forth along x between two ends (m), weaving with an amplitude (m) and a wavelength (m).
    Tunnel { from_x_m: f64, to_x_m: f64, amplitude_m: f64, wavelength_m: f64 },
    /// A repeated sequence of bends, from a start (m) in the direction of x.
    Bends { start_m: [f64; 2], bends: &'static [Bend] },
    /// Waypoints, with corners rounded to the smallest turning radius (m), and a stop at the last one.
    Waypoints { waypoints: Vec<Waypoint>, turn_radius_m: f64 },
}

/// A segment of a path with constant curvature (1/m, left positive).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    pub length_m: f64,
    pub curvature_per_m: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    pub range_sigma_m: f64,
    pub angle_sigma_rad: f64,
    /// Probability of a gross error of a reading.
    pub outlier_share: f64,
    /// Lost locks of each station per minute.
    pub lost_locks_per_minute: f64,
    /// Rate at which each station tracks the prism of the next one for a while, per minute.
    pub wrong_targets_per_minute: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    pub name: &'static str,
    pub duration_s: f64,
    pub cruise_m_per_s: f64,
    pub path: Path,
    /// The ground, in the frame of station 1.
    pub ground: Ground,
    pub noise: Noise,
    /// Readings per second of each station.
    pub rate_hz: f64,
    /// Time of the first reading of each station (s); `None` to draw it within the first period.
    pub stagger_s: Option<PerStation<f64>>,
    /// Prisms in the frame of the vehicle, whose origin is on the ground: x ahead, y left, z up (m).
    pub prisms_m: PerPrism<Vector3<f64>>,
    /// GNSS antennas, in the same frame.
    pub antennas_m: Option<[Vector3<f64>; 3]>,
    /// Positions of stations 2, 3, … in station 1's frame (m).
    pub stations_m: Vec<Vector3<f64>>,
    /// Yaws of stations 2, 3, …; `None` to draw them.
    pub yaws_rad: Option<Vec<f64>>,
    /// Number of sets of ten control points.
    pub control_point_sets: usize,
    /// Surveyed pillars on a line, for method A.
    pub pillars: bool,
    /// Start and end (s of the drive) of gaps of all stations; the vehicle drives on meanwhile.
    pub pauses_s: Vec<[f64; 2]>,
    /// Prism constant, to be added to every range of the simulated instruments (m).
    pub prism_constant_m: f64,
    pub errors: SystematicErrors,
    /// Kinds of errors that are drawn from the seed and replace those in `errors`.
    pub drawn_errors: Vec<ErrorKind>,
}
