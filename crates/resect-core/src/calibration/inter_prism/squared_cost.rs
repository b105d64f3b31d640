//! Cost of the squared distances, Σ (‖e‖² − d²)²/(2d)² over triplets and pairs, and its derivatives, in a time independent of the
//! number of triplets ([`super::compression`]).
//!
//! Near a good fit (‖e‖² − d²)/2d is the distance error itself, so the minima are close to those of the exact cost; far away the
//! cost grows faster. It is used to find the minima, which are then refined on the exact cost.

use multiversion::multiversion;
use nalgebra::Vector3;

use super::compression::{CONSTANT, Factor, MONOMIALS, compress};
use super::levenberg_marquardt::track_radius_m;
use super::pair_sums::{PairRows, PairSums};
use super::{CentredTriplets, NormalEquations, Parameters};

/// Number of rows that are processed together, and the nine rows padded with zeros to a multiple of it.
const LANES: usize = 4;
const ROWS: usize = 12;

type Column = [f64; ROWS];

/// The compressed triplets, for the search.
#[derive(Clone, Debug)]
pub struct SquaredCost {
    /// Columns of the triangles of pairs 12, 13 and 23, over 2d (m).
    columns: [[Column; MONOMIALS]; 3],
    pub inter_prism_m: [f64; 3],
    /// Displacement by a radian of yaw (m).
    pub radius_m: f64,
}

impl SquaredCost {
    pub fn of(data: &CentredTriplets) -> Self {
        let columns = std::array::from_fn(|pair| {
            padded(&compress(data, pair), 0.5 / data.inter_prism_m[pair])
        });
        Self { columns, inter_prism_m: data.inter_prism_m, radius_m: track_radius_m(data) }
    }

    /// Returns the triangle of a pair, over 2d (m).
    pub fn factor(&self, pair: usize) -> Factor {
        self.columns[pair].map(|column| std::array::from_fn(|row| column[row]))
    }

    pub fn at(&self, parameters: &Parameters) -> NormalEquations {
        NormalEquations::of(&sums(&self.columns, parameters))
    }
}

fn padded(factor: &Factor, scale: f64) -> [Column; MONOMIALS] {
    factor.map(|column| std::array::from_fn(|row| column.get(row).map_or(0.0, |v| scale * v)))
}

/// Pose (ψ, t) of frame b in frame a.
struct FramePose {
    sin: f64,
    cos: f64,
    t: Vector3<f64>,
}

// Code inside `sums` consists of plain loops in functions that are always inlined: closures and iterators would be compiled for the
// oldest processor.

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2+fma"))]
fn sums(columns: &[[Column; MONOMIALS]; 3], p: &Parameters) -> [PairSums<1>; 3] {
    let t = [Vector3::new(p[0], p[1], p[2]), Vector3::new(p[4], p[5], p[6])];
    let [(sin_2, cos_2), (sin_3, cos_3)] = [p[3].sin_cos(), p[7].sin_cos()];
    // Pair 23 has the relative pose, ψ = ψ3 − ψ2 and t = R2ᵀ(t3 − t2).
    let apart = t[1] - t[0];
    let relative = FramePose {
        sin: sin_3 * cos_2 - cos_3 * sin_2,
        cos: cos_3 * cos_2 + sin_3 * sin_2,
        t: Vector3::new(
            cos_2 * apart.x + sin_2 * apart.y,
            cos_2 * apart.y - sin_2 * apart.x,
            apart.z,
        ),
    };
    let still = FramePose { sin: 0.0, cos: 1.0, t: Vector3::zeros() };
    let of_2 = FramePose { sin: sin_2, cos: cos_2, t: t[0] };
    let of_3 = FramePose { sin: sin_3, cos: cos_3, t: t[1] };
    [
        pair(&columns[0], &still, &of_2, false),
        pair(&columns[1], &still, &of_3, false),
        pair(&columns[2], &of_2, &relative, true),
    ]
}

/// Returns the sums of a pair. Station a has the rotation of `a` in frame 1, and station b the pose `b` in frame a.
#[inline(always)]
fn pair(columns: &[Column; MONOMIALS], a: &FramePose, b: &FramePose, moving: bool) -> PairSums<1> {
    let mut sums = PairSums::<LANES>::ZERO;
    for start in (0..ROWS).step_by(LANES) {
        sums.add::<true>(&rows(columns, start, a, b), moving);
    }
    sums.fold()
}

#[inline(always)]
fn rows(
    columns: &[Column; MONOMIALS],
    start: usize,
    a: &FramePose,
    b: &FramePose,
) -> PairRows<LANES> {
    let FramePose { sin, cos, t } = *b;
    // Rᵀt, with derivative (v, −u) with respect to the yaw.
    let (u, v) = (cos * t.x + sin * t.y, cos * t.y - sin * t.x);
    let square = t.norm_squared();
    let mut rows =
        PairRows { u: [[0.0; LANES]; 3], a: [0.0; LANES], b: [0.0; LANES], r: [0.0; LANES] };
    for l in 0..LANES {
        let c = |monomial: usize| columns[monomial][start + l];
        rows.r[l] = cos * c(0)
            + sin * c(1)
            + t.x * c(2)
            + t.y * c(3)
            + t.z * c(4)
            + square * c(5)
            + u * c(6)
            + v * c(7)
            + c(CONSTANT);
        // Derivatives with respect to t and ψ in frame a.
        let by_x = c(2) + 2.0 * t.x * c(5) + cos * c(6) - sin * c(7);
        let by_y = c(3) + 2.0 * t.y * c(5) + sin * c(6) + cos * c(7);
        let by_z = c(4) + 2.0 * t.z * c(5);
        let by_yaw = cos * c(1) - sin * c(0) + v * c(6) - u * c(7);
        rows.u[0][l] = a.sin * by_y - a.cos * by_x;
        rows.u[1][l] = -a.sin * by_x - a.cos * by_y;
        rows.u[2][l] = -by_z;
        // The yaw of station a rotates t as well.
        rows.a[l] = t.y * by_x - t.x * by_y - by_yaw;
        rows.b[l] = -by_yaw;
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::super::normal_equations::tests::irregular;
    use super::*;
    use crate::calibration::inter_prism::PAIRS;
    use crate::geometry::LevelTransform;

    /// Σ (‖e‖² − d²)²/(2d)², computed triplet by triplet.
    fn direct(data: &CentredTriplets, parameters: &Parameters) -> f64 {
        let errors = data.distance_errors_m(parameters);
        errors
            .iter()
            .enumerate()
            .map(|(i, error)| {
                let d = data.inter_prism_m[i % PAIRS.len()];
                (((error + d).powi(2) - d * d) / (2.0 * d)).powi(2)
            })
            .sum()
    }

    #[test]
    fn the_cost_is_that_of_the_triplets_one_by_one() {
        let (data, parameters) = irregular(700);
        let cost = SquaredCost::of(&data);
        for turn in 0..20 {
            let turned = data.turned(&parameters, f64::from(turn));
            let expected = direct(&data, &turned);
            let found = cost.at(&turned).cost;
            assert!((found - expected).abs() < 1e-9 * expected, "{found} instead of {expected}");
        }
    }

    /// Precision is sufficient at a fit of millimetres, with the cancellation of squares of tens of metres.
    #[test]
    fn a_good_fit_keeps_its_digits() {
        let (mut data, parameters) = irregular(700);
        // Prisms 2 and 3 at a known distance from prism 1, to a millimetre.
        let poses = [0, 4].map(|at| {
            let moved = Vector3::new(parameters[at], parameters[at + 1], parameters[at + 2]);
            LevelTransform::new(moved, parameters[at + 3]).inverse()
        });
        for i in 0..data.len() {
            let at = Vector3::from_fn(|axis, _| data.coordinates[0][axis][i]);
            let heading = 0.3 * i as f64;
            let noise = 0.001 * (i as f64 * 78.233).sin();
            for (slot, angle) in [0.0, 1.9].into_iter().enumerate() {
                let (sin, cos) = (heading + angle).sin_cos();
                let placed = at + (0.8 + noise) * Vector3::new(0.9 * cos, 0.9 * sin, 0.43589);
                let seen = poses[slot].apply(&placed);
                for axis in 0..3 {
                    data.coordinates[slot + 1][axis][i] = seen[axis];
                }
            }
        }
        data.inter_prism_m = [0.8, 0.8, 0.8 * 0.9 * 2.0 * 0.95_f64.sin()];
        let cost = SquaredCost::of(&data);
        let (found, expected) = (cost.at(&parameters).cost, direct(&data, &parameters));
        assert!(expected < 0.01, "{expected}");
        assert!((found - expected).abs() < 1e-9 * expected, "{found} instead of {expected}");
    }

    #[test]
    fn gradient_and_matrix_match_numerical_differences() {
        let (data, parameters) = irregular(100);
        let cost = SquaredCost::of(&data);
        let normal = cost.at(&parameters);
        let step = 1e-5;
        let shifted = |k: usize, by: f64| {
            let mut p = parameters;
            p[k] += by;
            p
        };
        for k in 0..8 {
            let (above, below) = (cost.at(&shifted(k, step)), cost.at(&shifted(k, -step)));
            let numerical = (above.cost - below.cost) / (4.0 * step);
            let scale = normal.gradient.amax();
            assert!((numerical - normal.gradient[k]).abs() < 1e-6 * scale, "parameter {k}");
        }
        // JᵀJ from the rows of J by differences of residuals, weighted like those of the triplets.
        let residuals = |p: &Parameters| {
            let errors = data.distance_errors_m(p);
            nalgebra::DVector::from_iterator(
                errors.len(),
                errors.iter().enumerate().map(|(i, error)| {
                    let d = data.inter_prism_m[i % PAIRS.len()];
                    ((error + d).powi(2) - d * d) / (2.0 * d)
                }),
            )
        };
        let by: Vec<_> = (0..8)
            .map(|k| (residuals(&shifted(k, step)) - residuals(&shifted(k, -step))) / (2.0 * step))
            .collect();
        for i in 0..8 {
            for j in 0..8 {
                let expected = by[i].dot(&by[j]);
                let scale = (by[i].norm_squared() * by[j].norm_squared()).sqrt();
                assert!((normal.matrix[(i, j)] - expected).abs() < 1e-6 * scale, "{i}, {j}");
            }
        }
    }
}
