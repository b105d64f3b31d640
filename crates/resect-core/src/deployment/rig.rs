//! The prisms on the vehicle.

use nalgebra::Vector3;

use super::pairs::PAIRS;

/// Inter-prism distances, and where known the prisms' layout.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// α = d12, β = d13, γ = d23 (m).
    pub inter_prism_m: [f64; 3],
    /// One static station's view of the three prisms (m, z up), when a reading of the rig is there.
    /// Which prism stands higher is what tells the solution from its mirror twin.
    pub prisms_m: Option<[Vector3<f64>; 3]>,
    /// The prisms in the vehicle's own frame (m), where `deployment.toml` gives them.
    pub in_vehicle_m: Option<[Vector3<f64>; 3]>,
    /// Distances 12, 13, 23 between the GNSS antennas (m).
    pub inter_antenna_m: Option<[f64; 3]>,
}

impl Rig {
    /// How much higher prism 1 stands than prisms 2 and 3 (m), as seen by the static station.
    pub fn height_differences_m(&self) -> Option<[f64; 2]> {
        self.prisms_m.map(|p| [p[0].z - p[1].z, p[0].z - p[2].z])
    }
}

/// Distances 12, 13, 23 of three points (m).
pub fn pairwise_distances(points: &[Vector3<f64>; 3]) -> [f64; 3] {
    PAIRS.map(|(a, b)| (points[a] - points[b]).norm())
}
