//! The cost of the squared distances, Σ (‖e‖² − d²)²/(2d)² over triplets and pairs, and its derivatives, in a time that
//! does not depend on the number of triplets ([`super::compression`]).
//!
//! Near a good fit (‖e‖² − d²)/2d is the distance error itself, so its minima lie close to those of the exact cost; far
//! away it grows faster. It finds the minima, exact passes finish them.

use multiversion::multiversion;
use nalgebra::Vector3;

use super::compression::{CONSTANT, Factor, MONOMIALS, compress};
use super::levenberg_marquardt::track_radius_m;
use super::sums::{Rows, Sums};
use super::{CentredTriplets, NormalEquations, Parameters};

/// Nine rows and some that are zero: as many as vector registers hold.
const ROWS: usize = 12;

type Column = [f64; ROWS];

/// All that the search needs of the triplets.
#[derive(Clone, Debug)]
pub struct SquaredCost {
    /// Of pairs 12, 13 and 23, over 2d: metres.
    columns: [[Column; MONOMIALS]; 3],
    pub inter_prism_m: [f64; 3],
    /// What a radian of yaw moves (m).
    pub radius_m: f64,
}

impl SquaredCost {
    pub fn of(data: &CentredTriplets) -> Self {
        let columns = std::array::from_fn(|pair| {
            padded(&compress(data, pair), 0.5 / data.inter_prism_m[pair])
        });
        Self { columns, inter_prism_m: data.inter_prism_m, radius_m: track_radius_m(data) }
    }

    /// Triangle of a pair, over 2d (m).
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

/// Residuals of a pair and their derivatives by the pose (ψ, t) of frame b in frame a.
struct PairRows {
    residual: Column,
    by_translation: [Column; 3],
    by_yaw: Column,
}

#[inline(always)]
fn pair_rows(c: &[Column; MONOMIALS], yaw_rad: f64, t: &Vector3<f64>) -> PairRows {
    let (sin, cos) = yaw_rad.sin_cos();
    // Rᵀt, whose derivative by the yaw is (v, −u).
    let (u, v) = (cos * t.x + sin * t.y, cos * t.y - sin * t.x);
    let square = t.norm_squared();
    let mut rows =
        PairRows { residual: [0.0; ROWS], by_translation: [[0.0; ROWS]; 3], by_yaw: [0.0; ROWS] };
    for i in 0..ROWS {
        rows.residual[i] = cos * c[0][i]
            + sin * c[1][i]
            + t.x * c[2][i]
            + t.y * c[3][i]
            + t.z * c[4][i]
            + square * c[5][i]
            + u * c[6][i]
            + v * c[7][i]
            + c[CONSTANT][i];
        rows.by_translation[0][i] = c[2][i] + 2.0 * t.x * c[5][i] + cos * c[6][i] - sin * c[7][i];
        rows.by_translation[1][i] = c[3][i] + 2.0 * t.y * c[5][i] + sin * c[6][i] + cos * c[7][i];
        rows.by_translation[2][i] = c[4][i] + 2.0 * t.z * c[5][i];
        rows.by_yaw[i] = cos * c[1][i] - sin * c[0][i] + v * c[6][i] - u * c[7][i];
    }
    rows
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2+fma"))]
fn sums(columns: &[[Column; MONOMIALS]; 3], p: &Parameters) -> [Sums<1>; 3] {
    let translations = [Vector3::new(p[0], p[1], p[2]), Vector3::new(p[4], p[5], p[6])];
    let yaws = [p[3], p[7]];
    let with_station_1 = |slot: usize| {
        let rows = pair_rows(&columns[slot], yaws[slot], &translations[slot]);
        let mut sums = Sums::<ROWS>::ZERO;
        let u = rows.by_translation.map(|column| column.map(|v| -v));
        let b = rows.by_yaw.map(|v| -v);
        sums.add::<true>(&Rows { u, a: [0.0; ROWS], b, r: rows.residual }, false);
        sums.fold()
    };
    [with_station_1(0), with_station_1(1), between_2_and_3(&columns[2], &yaws, &translations)]
}

/// Pair 23, whose pose is relative: ψ = ψ3 − ψ2, t = R2ᵀ(t3 − t2).
#[inline(always)]
fn between_2_and_3(
    columns: &[Column; MONOMIALS],
    yaws: &[f64; 2],
    translations: &[Vector3<f64>; 2],
) -> Sums<1> {
    let (sin, cos) = yaws[0].sin_cos();
    let apart = translations[1] - translations[0];
    let t = Vector3::new(cos * apart.x + sin * apart.y, cos * apart.y - sin * apart.x, apart.z);
    let rows = pair_rows(columns, yaws[1] - yaws[0], &t);
    let mut turned = Rows { u: [[0.0; ROWS]; 3], a: [0.0; ROWS], b: [0.0; ROWS], r: rows.residual };
    let [by_x, by_y, by_z] = &rows.by_translation;
    for i in 0..ROWS {
        turned.u[0][i] = sin * by_y[i] - cos * by_x[i];
        turned.u[1][i] = -sin * by_x[i] - cos * by_y[i];
        turned.u[2][i] = -by_z[i];
        // The yaw of station 2 turns t as well.
        turned.a[i] = t.y * by_x[i] - t.x * by_y[i] - rows.by_yaw[i];
        turned.b[i] = -rows.by_yaw[i];
    }
    let mut sums = Sums::<ROWS>::ZERO;
    sums.add::<true>(&turned, true);
    sums.fold()
}

#[cfg(test)]
mod tests {
    use super::super::normal_equations::tests::irregular;
    use super::*;
    use crate::deployment::PAIRS;
    use crate::geometry::LevelTransform;

    /// Σ (‖e‖² − d²)²/(2d)², triplet by triplet.
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

    /// Where it matters: at a fit of millimetres, with all the cancellation of squares of tens of metres.
    #[test]
    fn a_good_fit_keeps_its_digits() {
        let (mut data, parameters) = irregular(700);
        // Prisms 2 and 3 a known distance beside prism 1, to a millimetre.
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
        // JᵀJ from the rows of J, which are differences of residuals: the weights make them the triplets' own.
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
