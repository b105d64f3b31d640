//! The prisms on the vehicle.

use nalgebra::Vector3;

use super::pairs::PAIRS;

/// Inter-prism distances, and the positions of the prisms if known.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// α = d12, β = d13, γ = d23 (m).
    pub inter_prism_m: [f64; 3],
    /// Positions of the three prisms by one static station (m, z up); `None` without a reading of the rig. The order of their
    /// heights distinguishes the solution from its mirror twin.
    pub prisms_m: Option<[Vector3<f64>; 3]>,
    /// Prisms in the vehicle's own frame (m); `None` unless `deployment.toml` gives them.
    pub in_vehicle_m: Option<[Vector3<f64>; 3]>,
    /// Distances 12, 13, 23 between the GNSS antennas (m).
    pub inter_antenna_m: Option<[f64; 3]>,
}

impl Rig {
    /// Heights of prism 1 above prisms 2 and 3 (m), by the static station; `None` without a reading of the rig.
    pub fn height_differences_m(&self) -> Option<[f64; 2]> {
        self.prisms_m.map(|p| [p[0].z - p[1].z, p[0].z - p[2].z])
    }
}

/// Distances 12, 13, 23 of three points (m).
pub fn pairwise_distances(points: &[Vector3<f64>; 3]) -> [f64; 3] {
    PAIRS.map(|(a, b)| (points[a] - points[b]).norm())
}
