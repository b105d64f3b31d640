//! The prisms on the vehicle.

use nalgebra::Vector3;

use crate::network::{Pair, PerPair, PerPrism};

/// Inter-prism distances, and the positions of the prisms if known.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// Distances between the prisms (m); of three prisms α = d12, β = d13, γ = d23.
    pub inter_prism_m: PerPair<f64>,
    /// Positions of the prisms by one static station (m, z up); `None` without a reading of the rig. The order of their
    /// heights distinguishes the solution from its mirror twin.
    pub prisms_m: Option<PerPrism<Vector3<f64>>>,
    /// Prisms in the vehicle's own frame (m); `None` unless `deployment.toml` gives them.
    pub in_vehicle_m: Option<PerPrism<Vector3<f64>>>,
    /// Distances 12, 13, 23 between the GNSS antennas (m).
    pub inter_antenna_m: Option<[f64; 3]>,
}

impl Rig {
    /// Heights of prism 1 above the other prisms (m), by the static station; `None` without a reading of the rig.
    pub fn height_differences_m(&self) -> Option<Vec<f64>> {
        let (first, others) = self.prisms_m.as_ref()?.as_slice().split_first()?;
        Some(others.iter().map(|other| first.z - other.z).collect())
    }

    /// Jacobian of the distances by the prism constant of the reading; zeros without a reading of the rig.
    pub fn distances_by_prism_constant(&self) -> PerPair<f64> {
        let Some(prisms_m) = &self.prisms_m else {
            return PerPair::repeat(self.inter_prism_m.len(), 0.0);
        };
        let jacobian = |pair: Pair| {
            let [first_m, second_m] = [prisms_m[pair.first], prisms_m[pair.second]];
            let along = (first_m - second_m).normalize();
            (first_m.normalize() - second_m.normalize()).dot(&along)
        };
        Pair::among(prisms_m.len()).map(jacobian).collect()
    }
}

/// Distances between points (m).
pub fn pairwise_distances(points: &[Vector3<f64>]) -> PerPair<f64> {
    let distance_m = |pair: Pair| {
        let [first, second] = pair.indices();
        (points[first] - points[second]).norm()
    };
    Pair::among(points.len()).map(distance_m).collect()
}
