//! Cost, gradient and Gauss–Newton matrix of method D, in one pass over the data.
//!
//! For a pair with difference e = T_a q_a − T_b q_b, distance ‖e‖ and unit vector u = e/‖e‖, the residual is r = ‖e‖ − d. The
//! derivatives of r are ±u for a translation and ±u·(dR/dψ q) for a yaw. The sums for the 8×8 matrix ([`super::pair_sums`]) are
//! accumulated per pair, as `[f64; LANES]` each, so that the compiler vectorises the inner loops. `multiversion` selects AVX-512 or
//! AVX2 if the processor has it.

use std::ops::Range;

use multiversion::multiversion;
use nalgebra::{SMatrix, SVector};

use super::pair_sums::{PairRows, PairSums, by_pair, cost, gradient, matrix};
use super::{CentredTriplets, Parameters};

/// JᵀJ, Jᵀr and rᵀr of all triplets at a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalEquations {
    pub matrix: SMatrix<f64, 8, 8>,
    pub gradient: SVector<f64, 8>,
    /// Sum of squared residuals (m²).
    pub cost: f64,
}

impl NormalEquations {
    pub fn of(sums: &[PairSums<1>; 3]) -> Self {
        Self { matrix: matrix(sums), gradient: gradient(sums), cost: cost(sums) }
    }

    /// Returns the normal equations of the distances (Vaidis et al. 2022, eq. (3)).
    pub fn at(data: &CentredTriplets, parameters: &Parameters) -> Self {
        Self::over(data, parameters, 0..data.len())
    }

    /// Returns the normal equations of the distances of some of the triplets.
    pub fn over(data: &CentredTriplets, parameters: &Parameters, instants: Range<usize>) -> Self {
        Self::of(&sums_over(data, parameters, instants, true))
    }
}

/// Returns Σ ∂r/∂p of each pair: the sensitivity of the gradient to its inter-prism distance.
pub fn distance_pulls(data: &CentredTriplets, parameters: &Parameters) -> [SVector<f64, 8>; 3] {
    by_pair(&sums_over(data, parameters, 0..data.len(), false))
}

fn sums_over(
    data: &CentredTriplets,
    parameters: &Parameters,
    instants: Range<usize>,
    for_solver: bool,
) -> [PairSums<1>; 3] {
    let coordinates =
        data.coordinates.each_ref().map(|s| s.each_ref().map(|axis| &axis[instants.clone()]));
    let p = parameters.as_slice();
    sum(&coordinates, &[pose(&p[..4]), pose(&p[4..])], &data.inter_prism_m, for_solver)
}

#[derive(Clone, Copy)]
struct PairPose {
    x: f64,
    y: f64,
    z: f64,
    sin: f64,
    cos: f64,
}

fn pose(p: &[f64]) -> PairPose {
    let (sin, cos) = p[3].sin_cos();
    PairPose { x: p[0], y: p[1], z: p[2], sin, cos }
}

const LANES: usize = 8;

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
fn sum(
    coordinates: &[[&[f64]; 3]; 3],
    poses: &[PairPose; 2],
    inter_prism_m: &[f64; 3],
    for_solver: bool,
) -> [PairSums<1>; 3] {
    if for_solver {
        sum_all::<true>(coordinates, poses, inter_prism_m)
    } else {
        sum_all::<false>(coordinates, poses, inter_prism_m)
    }
}

#[inline(always)]
fn sum_all<const FOR_SOLVER: bool>(
    coordinates: &[[&[f64]; 3]; 3],
    poses: &[PairPose; 2],
    inter_prism_m: &[f64; 3],
) -> [PairSums<1>; 3] {
    let count = coordinates[0][0].len();
    let whole = count / LANES * LANES;
    let mut wide = [PairSums::<LANES>::ZERO; 3];
    for start in (0..whole).step_by(LANES) {
        add::<LANES, FOR_SOLVER>(coordinates, start, poses, inter_prism_m, &mut wide);
    }
    let mut total = wide.map(|s| s.fold());
    for start in whole..count {
        add::<1, FOR_SOLVER>(coordinates, start, poses, inter_prism_m, &mut total);
    }
    total
}

/// Adds L consecutive instants.
#[inline(always)]
fn add<const L: usize, const FOR_SOLVER: bool>(
    coordinates: &[[&[f64]; 3]; 3],
    start: usize,
    poses: &[PairPose; 2],
    inter_prism_m: &[f64; 3],
    sums: &mut [PairSums<L>; 3],
) {
    let load = |station: usize, axis: usize| -> [f64; L] {
        coordinates[station][axis][start..start + L].try_into().expect("L long")
    };
    let zero = [0.0; L];
    let first = PlacedPrisms { position: [0, 1, 2].map(|axis| load(0, axis)), by_yaw: [zero; 2] };
    let mut moved = [PlacedPrisms { position: [zero; 3], by_yaw: [zero; 2] }; 2];
    for slot in 0..2 {
        let pose = poses[slot];
        let (x, y, z) = (load(slot + 1, 0), load(slot + 1, 1), load(slot + 1, 2));
        let PlacedPrisms { position, by_yaw } = &mut moved[slot];
        for l in 0..L {
            let (rx, ry) = (pose.cos * x[l] - pose.sin * y[l], pose.sin * x[l] + pose.cos * y[l]);
            position[0][l] = rx + pose.x;
            position[1][l] = ry + pose.y;
            position[2][l] = z[l] + pose.z;
            by_yaw[0][l] = -ry;
            by_yaw[1][l] = rx;
        }
    }
    let [second, third] = &moved;
    add_pair::<L, FOR_SOLVER>(&first, second, inter_prism_m[0], false, &mut sums[0]);
    add_pair::<L, FOR_SOLVER>(&first, third, inter_prism_m[1], false, &mut sums[1]);
    add_pair::<L, FOR_SOLVER>(second, third, inter_prism_m[2], true, &mut sums[2]);
}

/// Prism positions of one station in station 1's frame at L instants (m).
#[derive(Clone, Copy)]
struct PlacedPrisms<const L: usize> {
    position: [[f64; L]; 3],
    /// Derivative of x and y with respect to the station's yaw; z has none.
    by_yaw: [[f64; L]; 2],
}

/// Adds one pair of stations; `moving` is true if station a has unknowns too (only in pair 23).
#[inline(always)]
fn add_pair<const L: usize, const FOR_SOLVER: bool>(
    station_a: &PlacedPrisms<L>,
    station_b: &PlacedPrisms<L>,
    distance_m: f64,
    moving: bool,
    sums: &mut PairSums<L>,
) {
    let PlacedPrisms { position: at_a, by_yaw: turned_a } = station_a;
    let PlacedPrisms { position: at_b, by_yaw: turned_b } = station_b;
    let mut u = [[0.0; L]; 3];
    let (mut r, mut a, mut b) = ([0.0; L], [0.0; L], [0.0; L]);
    for l in 0..L {
        let e = [at_a[0][l] - at_b[0][l], at_a[1][l] - at_b[1][l], at_a[2][l] - at_b[2][l]];
        let norm = (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]).sqrt();
        // Coincident points have no direction; any finite one keeps the sums finite.
        let inverse = 1.0 / norm.max(1e-12);
        for axis in 0..3 {
            u[axis][l] = e[axis] * inverse;
        }
        r[l] = norm - distance_m;
        a[l] = u[0][l] * turned_a[0][l] + u[1][l] * turned_a[1][l];
        b[l] = u[0][l] * turned_b[0][l] + u[1][l] * turned_b[1][l];
    }
    sums.add::<FOR_SOLVER>(&PairRows { u, a, b, r }, moving);
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::pipeline::Triplets;
    use nalgebra::Vector3;

    /// Irregular points and parameters of no real rig; the derivatives must be right for any.
    pub fn irregular(count: usize) -> (CentredTriplets, Parameters) {
        let wave = |seed: f64, i: usize| {
            40.0 * (43758.5453 * (seed * 12.9898 + i as f64 * 78.233).sin()).fract()
        };
        let points = |s: f64| -> Vec<Vector3<f64>> {
            (0..count)
                .map(|i| Vector3::new(wave(s, i), wave(s + 1.0, i), wave(s + 2.0, i) / 9.0))
                .collect()
        };
        let triplets = Triplets::new(
            (0..count).map(|i| i as f64).collect(),
            vec![0; count],
            [points(0.1), points(5.3), points(9.7)],
        );
        let parameters =
            Parameters::from_column_slice(&[1.0, -2.0, 0.3, 0.4, -0.7, 0.2, 0.9, -1.3]);
        (CentredTriplets::new(&triplets, [0.7, 0.9, 1.1]), parameters)
    }

    #[test]
    fn gradient_and_pulls_match_numerical_differences() {
        let (data, parameters) = irregular(29);
        let normal = NormalEquations::at(&data, &parameters);
        let pulls = distance_pulls(&data, &parameters);
        for k in 0..8 {
            let step = 1e-6;
            let shifted = |by: f64| {
                let mut p = parameters;
                p[k] += by;
                p
            };
            let numerical = (NormalEquations::at(&data, &shifted(step)).cost
                - NormalEquations::at(&data, &shifted(-step)).cost)
                / (4.0 * step);
            let scale = normal.gradient.amax();
            assert!((numerical - normal.gradient[k]).abs() < 1e-6 * scale, "parameter {k}");
        }
        // r depends on d with slope −1, so ∂(Jᵀr)/∂d_pair = −Σ ∂r/∂p of that pair.
        for pair in 0..3 {
            let mut other = data.clone();
            other.inter_prism_m[pair] += 1e-3;
            let change = NormalEquations::at(&other, &parameters).gradient - normal.gradient;
            assert!((change / 1e-3 + pulls[pair]).amax() < 1e-6 * normal.gradient.amax());
        }
    }

    #[test]
    fn the_matrix_is_the_sum_of_outer_products() {
        let (data, parameters) = irregular(13);
        let normal = NormalEquations::at(&data, &parameters);
        let mut expected = SMatrix::<f64, 8, 8>::zeros();
        for i in 0..data.len() {
            for pair in 0..3 {
                // The gradient of one pair at one instant over its residual is the row of J.
                let one = data.select(&[i]);
                let row = distance_pulls(&one, &parameters)[pair];
                expected += row * row.transpose();
            }
        }
        assert!((normal.matrix - expected).amax() < 1e-9 * expected.amax());
    }

    #[test]
    fn parts_add_up_to_the_whole_at_any_cut() {
        let (data, parameters) = irregular(37);
        let whole = NormalEquations::at(&data, &parameters);
        for cut in [0, 1, 7, 8, 9, 36, 37] {
            let left = NormalEquations::over(&data, &parameters, 0..cut);
            let right = NormalEquations::over(&data, &parameters, cut..37);
            let off = left.gradient + right.gradient - whole.gradient;
            assert!(off.amax() < 1e-9 * whole.gradient.amax());
            let off = left.matrix + right.matrix - whole.matrix;
            assert!(off.amax() < 1e-9 * whole.matrix.amax());
        }
    }
}
