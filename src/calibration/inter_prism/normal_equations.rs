//! The one fused pass over the data: cost, gradient and Gauss–Newton matrix of method D together.
//!
//! For a pair with difference e = T_a q_a − T_b q_b, distance ‖e‖ and unit vector u = e/‖e‖, the residual is
//! r = ‖e‖ − d and its derivatives are ±u for a translation and ±u·(dR/dψ q) for a yaw. The sums that the
//! 8×8 matrix needs are kept per pair, as `[f64; LANES]` each, so that the compiler turns the inner loops
//! into vector instructions; `multiversion` picks AVX-512 or AVX2 where the processor has it.

use std::ops::Range;

use multiversion::multiversion;
use nalgebra::{SMatrix, SVector};

use super::{CentredTriplets, Parameters};

/// JᵀJ, Jᵀr and rᵀr of all triplets at some parameters: what the solver needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalEquations {
    pub matrix: SMatrix<f64, 8, 8>,
    pub gradient: SVector<f64, 8>,
    /// Sum of squared residuals (m²).
    pub cost: f64,
}

/// Jᵀr and Σ ∂r/∂p of each pair, over some of the triplets: what the uncertainty needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulls {
    pub gradient: SVector<f64, 8>,
    /// What an error of an inter-prism distance pulls at.
    pub by_pair: [SVector<f64, 8>; 3],
}

impl NormalEquations {
    pub fn at(data: &CentredTriplets, parameters: &Parameters) -> Self {
        let sums = sums_over(data, parameters, 0..data.len(), true);
        Self {
            matrix: matrix(&sums),
            gradient: gradient(&sums),
            cost: sums.iter().map(|s| s.rr[0]).sum(),
        }
    }
}

impl Pulls {
    pub fn over(data: &CentredTriplets, parameters: &Parameters, instants: Range<usize>) -> Self {
        let sums = sums_over(data, parameters, instants, false);
        Self { gradient: gradient(&sums), by_pair: by_pair(&sums) }
    }
}

fn sums_over(
    data: &CentredTriplets,
    parameters: &Parameters,
    instants: Range<usize>,
    for_solver: bool,
) -> [Sums<1>; 3] {
    let coordinates =
        data.coordinates.each_ref().map(|s| s.each_ref().map(|axis| &axis[instants.clone()]));
    let p = parameters.as_slice();
    sum(&coordinates, &[pose(&p[..4]), pose(&p[4..])], &data.inter_prism_m, for_solver)
}

#[derive(Clone, Copy)]
struct Pose {
    x: f64,
    y: f64,
    z: f64,
    sin: f64,
    cos: f64,
}

fn pose(p: &[f64]) -> Pose {
    let (sin, cos) = p[3].sin_cos();
    Pose { x: p[0], y: p[1], z: p[2], sin, cos }
}

const LANES: usize = 8;

/// Sums of one pair: products of the unit vector u, of a = u·R'q_a and b = u·R'q_b, and of the residual r.
#[derive(Clone, Copy)]
#[repr(C)]
struct Sums<const L: usize> {
    uu: [[f64; L]; 6],
    ua: [[f64; L]; 3],
    ub: [[f64; L]; 3],
    aa: [f64; L],
    ab: [f64; L],
    bb: [f64; L],
    ur: [[f64; L]; 3],
    ar: [f64; L],
    br: [f64; L],
    rr: [f64; L],
    u: [[f64; L]; 3],
    a: [f64; L],
    b: [f64; L],
}

impl<const L: usize> Sums<L> {
    const ZERO: Self = Self {
        uu: [[0.0; L]; 6],
        ua: [[0.0; L]; 3],
        ub: [[0.0; L]; 3],
        aa: [0.0; L],
        ab: [0.0; L],
        bb: [0.0; L],
        ur: [[0.0; L]; 3],
        ar: [0.0; L],
        br: [0.0; L],
        rr: [0.0; L],
        u: [[0.0; L]; 3],
        a: [0.0; L],
        b: [0.0; L],
    };
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
fn sum(
    coordinates: &[[&[f64]; 3]; 3],
    poses: &[Pose; 2],
    inter_prism_m: &[f64; 3],
    for_solver: bool,
) -> [Sums<1>; 3] {
    if for_solver {
        sum_all::<true>(coordinates, poses, inter_prism_m)
    } else {
        sum_all::<false>(coordinates, poses, inter_prism_m)
    }
}

#[inline(always)]
fn sum_all<const FOR_SOLVER: bool>(
    coordinates: &[[&[f64]; 3]; 3],
    poses: &[Pose; 2],
    inter_prism_m: &[f64; 3],
) -> [Sums<1>; 3] {
    let count = coordinates[0][0].len();
    let whole = count / LANES * LANES;
    let mut wide = [Sums::<LANES>::ZERO; 3];
    for start in (0..whole).step_by(LANES) {
        add::<LANES, FOR_SOLVER>(coordinates, start, poses, inter_prism_m, &mut wide);
    }
    let mut total = wide.map(|s| fold(&s));
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
    poses: &[Pose; 2],
    inter_prism_m: &[f64; 3],
    sums: &mut [Sums<L>; 3],
) {
    let load = |station: usize, axis: usize| -> [f64; L] {
        coordinates[station][axis][start..start + L].try_into().expect("L long")
    };
    let q1 = [load(0, 0), load(0, 1), load(0, 2)];
    let zero = [0.0; L];
    // Positions in frame 1, and their derivatives by yaw (which has no z).
    let mut placed = [[zero; 3]; 2];
    let mut turned = [[zero; 2]; 2];
    for slot in 0..2 {
        let pose = poses[slot];
        let (x, y, z) = (load(slot + 1, 0), load(slot + 1, 1), load(slot + 1, 2));
        for l in 0..L {
            let (rx, ry) = (pose.cos * x[l] - pose.sin * y[l], pose.sin * x[l] + pose.cos * y[l]);
            placed[slot][0][l] = rx + pose.x;
            placed[slot][1][l] = ry + pose.y;
            placed[slot][2][l] = z[l] + pose.z;
            turned[slot][0][l] = -ry;
            turned[slot][1][l] = rx;
        }
    }
    let fixed = [zero; 2];
    add_pair::<L, FOR_SOLVER>(
        &q1,
        &fixed,
        &placed[0],
        &turned[0],
        inter_prism_m[0],
        false,
        &mut sums[0],
    );
    add_pair::<L, FOR_SOLVER>(
        &q1,
        &fixed,
        &placed[1],
        &turned[1],
        inter_prism_m[1],
        false,
        &mut sums[1],
    );
    add_pair::<L, FOR_SOLVER>(
        &placed[0],
        &turned[0],
        &placed[1],
        &turned[1],
        inter_prism_m[2],
        true,
        &mut sums[2],
    );
}

/// Adds one pair; `moving` says whether station a is free too (only in pair 23).
#[inline(always)]
fn add_pair<const L: usize, const FOR_SOLVER: bool>(
    at_a: &[[f64; L]; 3],
    turned_a: &[[f64; L]; 2],
    at_b: &[[f64; L]; 3],
    turned_b: &[[f64; L]; 2],
    distance_m: f64,
    moving: bool,
    sums: &mut Sums<L>,
) {
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
    for i in 0..3 {
        multiply_add(&mut sums.ur[i], &u[i], &r);
    }
    multiply_add(&mut sums.br, &b, &r);
    if moving {
        multiply_add(&mut sums.ar, &a, &r);
    }
    if FOR_SOLVER {
        let mut entry = 0;
        for i in 0..3 {
            for j in i..3 {
                multiply_add(&mut sums.uu[entry], &u[i], &u[j]);
                entry += 1;
            }
            multiply_add(&mut sums.ub[i], &u[i], &b);
        }
        multiply_add(&mut sums.bb, &b, &b);
        multiply_add(&mut sums.rr, &r, &r);
        if moving {
            for i in 0..3 {
                multiply_add(&mut sums.ua[i], &u[i], &a);
            }
            multiply_add(&mut sums.aa, &a, &a);
            multiply_add(&mut sums.ab, &a, &b);
        }
    } else {
        for l in 0..L {
            for i in 0..3 {
                sums.u[i][l] += u[i][l];
            }
            sums.a[l] += a[l];
            sums.b[l] += b[l];
        }
    }
}

#[inline(always)]
fn multiply_add<const L: usize>(sum: &mut [f64; L], a: &[f64; L], b: &[f64; L]) {
    for l in 0..L {
        sum[l] += a[l] * b[l];
    }
}

fn fold<const L: usize>(s: &Sums<L>) -> Sums<1> {
    let f = |lanes: [f64; L]| [lanes.iter().sum()];
    Sums {
        uu: s.uu.map(f),
        ua: s.ua.map(f),
        ub: s.ub.map(f),
        aa: f(s.aa),
        ab: f(s.ab),
        bb: f(s.bb),
        ur: s.ur.map(f),
        ar: f(s.ar),
        br: f(s.br),
        rr: f(s.rr),
        u: s.u.map(f),
        a: f(s.a),
        b: f(s.b),
    }
}

// Signs: station a moves the residual by +(u, a), station b by −(u, b). In pairs 12 and 13 station a is station 1,
// which is fixed; only pair 23 has parameters on both sides.

/// First parameter of the pair's station b.
fn first_of_b(pair: usize) -> usize {
    if pair == 0 { 0 } else { 4 }
}

fn matrix(sums: &[Sums<1>; 3]) -> SMatrix<f64, 8, 8> {
    let mut matrix = SMatrix::<f64, 8, 8>::zeros();
    for (pair, s) in sums.iter().enumerate() {
        let uu = |i: usize, j: usize| s.uu[[[0, 1, 2], [1, 3, 4], [2, 4, 5]][i][j]][0];
        let at = first_of_b(pair);
        for i in 0..3 {
            for j in 0..3 {
                matrix[(at + i, at + j)] += uu(i, j);
            }
            matrix[(at + i, at + 3)] += s.ub[i][0];
        }
        matrix[(at + 3, at + 3)] += s.bb[0];
        if pair == 2 {
            for i in 0..3 {
                for j in 0..3 {
                    matrix[(i, j)] += uu(i, j);
                    matrix[(i, 4 + j)] -= uu(i, j);
                }
                matrix[(i, 3)] += s.ua[i][0];
                matrix[(i, 7)] -= s.ub[i][0];
                matrix[(3, 4 + i)] -= s.ua[i][0];
            }
            matrix[(3, 3)] += s.aa[0];
            matrix[(3, 7)] -= s.ab[0];
        }
    }
    matrix.fill_lower_triangle_with_upper_triangle();
    matrix
}

fn gradient(sums: &[Sums<1>; 3]) -> SVector<f64, 8> {
    let mut total = SVector::zeros();
    for (pair, s) in sums.iter().enumerate() {
        add_row(&mut total, pair, &s.ur, &s.ar, &s.br);
    }
    total
}

fn by_pair(sums: &[Sums<1>; 3]) -> [SVector<f64, 8>; 3] {
    std::array::from_fn(|pair| {
        let mut row = SVector::zeros();
        add_row(&mut row, pair, &sums[pair].u, &sums[pair].a, &sums[pair].b);
        row
    })
}

/// Adds a sum of rows of J.
fn add_row(row: &mut SVector<f64, 8>, pair: usize, u: &[[f64; 1]; 3], a: &[f64; 1], b: &[f64; 1]) {
    let at = first_of_b(pair);
    for i in 0..3 {
        row[at + i] -= u[i][0];
    }
    row[at + 3] -= b[0];
    if pair == 2 {
        for i in 0..3 {
            row[i] += u[i][0];
        }
        row[3] += a[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::Triplets;
    use nalgebra::Vector3;

    /// Irregular points and parameters; no rig would look like this, the derivatives must hold anyway.
    fn irregular(count: usize) -> (CentredTriplets, Parameters) {
        let wave = |seed: f64, i: usize| (seed * 12.9898 + i as f64 * 78.233).sin() * 40.0;
        let points = |s: f64| {
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
        let pulls = Pulls::over(&data, &parameters, 0..data.len());
        assert!((normal.gradient - pulls.gradient).amax() < 1e-12 * normal.gradient.amax());
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
            assert!((change / 1e-3 + pulls.by_pair[pair]).amax() < 1e-6 * normal.gradient.amax());
        }
    }

    #[test]
    fn the_matrix_is_the_sum_of_outer_products() {
        let (data, parameters) = irregular(13);
        let normal = NormalEquations::at(&data, &parameters);
        let mut expected = SMatrix::<f64, 8, 8>::zeros();
        for i in 0..data.len() {
            for pair in 0..3 {
                // One instant, one pair: its gradient over its residual is the row of J.
                let one = data.select(&[i]);
                let row = Pulls::over(&one, &parameters, 0..1).by_pair[pair];
                expected += row * row.transpose();
            }
        }
        assert!((normal.matrix - expected).amax() < 1e-9 * expected.amax());
    }

    #[test]
    fn parts_add_up_to_the_whole_at_any_cut() {
        let (data, parameters) = irregular(37);
        let whole = Pulls::over(&data, &parameters, 0..37);
        for cut in [0, 1, 7, 8, 9, 36, 37] {
            let left = Pulls::over(&data, &parameters, 0..cut);
            let right = Pulls::over(&data, &parameters, cut..37);
            let off = left.gradient + right.gradient - whole.gradient;
            assert!(off.amax() < 1e-9 * whole.gradient.amax());
            for pair in 0..3 {
                let off = left.by_pair[pair] + right.by_pair[pair] - whole.by_pair[pair];
                assert!(off.amax() < 1e-9 * whole.by_pair[pair].amax());
            }
        }
    }
}
