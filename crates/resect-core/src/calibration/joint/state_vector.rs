//! The state vector of the joint estimate: which unknown has which index.

use nalgebra::{SMatrix, SVector};

/// Number of constants θ of a deployment: (x, y, z, yaw) of stations 2 and 3, then by station or pair from the indices below.
pub const CONSTANTS: usize = 36;
pub const CLOCKS: usize = 8;
pub const DRIFTS: usize = 10;
pub const LATENCIES: usize = 12;
pub const DISTANCES: usize = 15;
pub const LEANS: usize = 18;
pub const OFFSETS: usize = 24;
pub const SCALES: usize = 27;
pub const INDICES: usize = 30;
pub const COLLIMATIONS: usize = 33;

/// Number of slow states s of a block: changes of (x, y, z, yaw) of stations 2 and 3, and of their clocks; errors of the ranges of
/// stations 1 to 3; errors across the sight and upward of each.
pub const SLOW: usize = 19;
pub const SLOW_CLOCKS: usize = 8;
pub const SLOW_RANGES: usize = 10;
pub const SLOW_ACROSS: usize = 13;

/// Number of unknowns u of a block: shifts of stations 2 and 3 (m, station 1's frame), their clock offsets (s), latencies of
/// stations 1 to 3 (s), inter-prism distances (m).
pub const BLOCK: usize = 14;
pub const BLOCK_CLOCKS: usize = 6;
pub const BLOCK_LATENCIES: usize = 8;
pub const BLOCK_DISTANCES: usize = 11;

/// Constants θ (m, rad, s, shares), and a matrix of constants by constants.
pub type Constants = SVector<f64, CONSTANTS>;
pub type ConstantsMatrix = SMatrix<f64, CONSTANTS, CONSTANTS>;
/// Slow states s of a block (m, rad, s).
pub type Slow = SVector<f64, SLOW>;
/// Unknowns u of a block, or their gradient.
pub type BlockVector = SVector<f64, BLOCK>;

/// All unknowns: constants θ, slow states s of each block, and spline coefficients c of each segment.
#[derive(Clone, Debug)]
pub struct StateVector {
    pub constants: Constants,
    pub slow: Vec<Slow>,
    /// Coefficients of the splines by segment: x, y, z of each prism, knot by knot (m, station 1's frame).
    pub coefficients_m: Vec<Vec<f64>>,
}
