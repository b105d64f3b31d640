//! Cost of the squared distances, Σ (‖e‖² − d²)²/(2d)² over triplets and pairs, and its derivatives, in a time independent of the
//! number of triplets ([`super::compression`]).
//!
//! Near a good fit (‖e‖² − d²)/2d is the distance error itself, so the minima are close to those of the exact cost; far away the
//! cost grows faster. It is used to find the minima, which are then refined on the exact cost. The cost of a shared prism is the
//! exact one.

use multiversion::multiversion;
use nalgebra::Vector3;

use super::compression::{CONSTANT, Factor, MONOMIALS, compress};
use super::levenberg_marquardt::track_radius_m;
use super::pair_sums::{PairRows, PairSums};
use super::prism_network::UNKNOWNS_PER_STATION;
use super::{CentredTriplets, NormalEquations, Parameters, PrismNetwork};
use crate::network::{MOST_STATIONS, Number};

/// Number of rows that are processed together, and the nine rows padded with zeros to a multiple of it.
const LANES: usize = 4;
const ROWS: usize = 12;

type Column = [f64; ROWS];

/// The compressed triplets, for the search.
#[derive(Clone, Debug)]
pub struct SquaredCost {
    /// Columns of the triangle of each pair, over 2d (m).
    columns: Vec<[Column; MONOMIALS]>,
    pub network: PrismNetwork,
    /// Displacement by a radian of yaw (m).
    pub radius_m: f64,
}

impl SquaredCost {
    pub fn of(data: &CentredTriplets) -> Self {
        let columns = data.network.pairs.iter().map(|pair| {
            let scale = if pair.is_shared() { 1.0 } else { 0.5 / pair.distance_m };
            padded(&compress(data, pair), scale)
        });
        Self {
            columns: columns.collect(),
            network: data.network.clone(),
            radius_m: track_radius_m(data),
        }
    }

    /// Returns the triangle of a pair, over 2d (m).
    pub fn factor(&self, pair: usize) -> Factor {
        self.columns[pair].map(|column| std::array::from_fn(|row| column[row]))
    }

    pub fn at(&self, parameters: &Parameters) -> NormalEquations {
        let mut normal = NormalEquations::zeros(parameters.len());
        self.evaluate(parameters, &mut normal);
        normal
    }

    /// Replaces the normal equations by those at some parameters.
    pub fn evaluate(&self, parameters: &Parameters, normal: &mut NormalEquations) {
        normal.clear();
        let mut poses = [FramePose::FIRST; MOST_STATIONS];
        let unknowns = parameters.as_slice().chunks_exact(UNKNOWNS_PER_STATION);
        for (pose, p) in poses[1..].iter_mut().zip(unknowns) {
            *pose = FramePose::of(p);
        }
        for (columns, pair) in self.columns.iter().zip(&self.network.pairs) {
            let a = &poses[pair.stations.first.index()];
            let b = a.relative(&poses[pair.stations.second.index()]);
            let moving = pair.stations.first.index() > 0;
            sums(columns, a, &b, moving).add_to(pair.stations, normal);
        }
        normal.matrix.fill_lower_triangle_with_upper_triangle();
    }
}

fn padded(factor: &Factor, scale: f64) -> [Column; MONOMIALS] {
    factor.map(|column| std::array::from_fn(|row| column.get(row).map_or(0.0, |v| scale * v)))
}

/// Pose (ψ, t) of one frame in another.
#[derive(Clone, Copy)]
struct FramePose {
    sin: f64,
    cos: f64,
    t: Vector3<f64>,
}

impl FramePose {
    /// Station 1 in its own frame.
    const FIRST: Self = Self { sin: 0.0, cos: 1.0, t: Vector3::new(0.0, 0.0, 0.0) };

    fn of(p: &[f64]) -> Self {
        let (sin, cos) = p[3].sin_cos();
        Self { sin, cos, t: Vector3::new(p[0], p[1], p[2]) }
    }

    /// Returns the pose of another frame in this one: ψ = ψ_b − ψ_a and t = R_aᵀ(t_b − t_a).
    fn relative(&self, other: &Self) -> Self {
        let apart = other.t - self.t;
        Self {
            sin: other.sin * self.cos - other.cos * self.sin,
            cos: other.cos * self.cos + other.sin * self.sin,
            t: Vector3::new(
                self.cos * apart.x + self.sin * apart.y,
                self.cos * apart.y - self.sin * apart.x,
                apart.z,
            ),
        }
    }
}

// Code inside `sums` consists of plain loops in functions that are always inlined: closures and iterators would be compiled for the
// oldest processor.

/// Returns the sums of a pair. Station a has the rotation of `a` in frame 1, and station b the pose `b` in frame a.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2+fma"))]
fn sums(columns: &[Column; MONOMIALS], a: &FramePose, b: &FramePose, moving: bool) -> PairSums<1> {
    let mut sums = PairSums::<LANES>::ZERO;
    for start in (0..ROWS).step_by(LANES) {
        sums.add(&rows(columns, start, a, b), moving);
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
    use super::super::distance_pass::tests::{irregular, irregular_shared};
    use super::*;
    use crate::calibration::inter_prism::prism_network::FollowedPair;
    use crate::geometry::LevelTransform;
    use crate::network::Station;
    use nalgebra::DVector;

    /// (‖e‖² − d²)/2d of each pair of different prisms, and e of each shared one in the frame of station a, triplet by triplet.
    fn squared_residuals(data: &CentredTriplets, parameters: &Parameters) -> Vec<f64> {
        let mut residuals = Vec::new();
        for i in 0..data.len() {
            let placed_m = data.placed_m(parameters, i);
            for FollowedPair { stations, distance_m: d, prisms } in &data.network.pairs {
                let e = placed_m[stations.first] - placed_m[stations.second];
                match prisms {
                    Some(_) => residuals.push((e.norm_squared() - d * d) / (2.0 * d)),
                    None => {
                        let station1_from_a = data.pose(parameters, stations.first);
                        let turn = LevelTransform::new(Vector3::zeros(), -station1_from_a.yaw_rad);
                        residuals.extend(turn.rotate(&e).iter());
                    }
                }
            }
        }
        residuals
    }

    /// Sum of their squares.
    fn direct(data: &CentredTriplets, parameters: &Parameters) -> f64 {
        squared_residuals(data, parameters).iter().map(|residual| residual * residual).sum()
    }

    #[test]
    fn the_cost_is_that_of_the_triplets_one_by_one() {
        for (data, parameters) in [irregular(700), irregular_shared(700)] {
            let cost = SquaredCost::of(&data);
            for turn in 0..20 {
                let turned = data.turned(&parameters, f64::from(turn));
                let expected = direct(&data, &turned);
                let found = cost.at(&turned).cost;
                assert!((found - expected).abs() < 1e-9 * expected, "{found}, not {expected}");
            }
        }
    }

    /// Precision is sufficient at a fit of millimetres, with the cancellation of squares of tens of metres.
    #[test]
    fn a_good_fit_keeps_its_digits() {
        let (mut data, parameters) = irregular(700);
        // Prisms 2 and 3 at a known distance from prism 1, to a millimetre.
        let poses = [1, 2].map(|s| data.pose(&parameters, Station::at(s)).inverse());
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
        data.network = PrismNetwork::of_own_prisms([0.8, 0.8, 0.8 * 0.9 * 2.0 * 0.95_f64.sin()]);
        let cost = SquaredCost::of(&data);
        let (found, expected) = (cost.at(&parameters).cost, direct(&data, &parameters));
        assert!(expected < 0.01, "{expected}");
        assert!((found - expected).abs() < 1e-9 * expected, "{found} instead of {expected}");
    }

    #[test]
    fn gradient_and_matrix_match_numerical_differences() {
        for (data, parameters) in [irregular(100), irregular_shared(100)] {
            let cost = SquaredCost::of(&data);
            let normal = cost.at(&parameters);
            let step = 1e-5;
            let shifted = |k: usize, by: f64| {
                let mut p = parameters.clone();
                p[k] += by;
                p
            };
            for k in 0..parameters.len() {
                let (above, below) = (cost.at(&shifted(k, step)), cost.at(&shifted(k, -step)));
                let numerical = (above.cost - below.cost) / (4.0 * step);
                let scale = normal.gradient.amax();
                assert!((numerical - normal.gradient[k]).abs() < 1e-6 * scale, "parameter {k}");
            }
            // JᵀJ from the rows of J by differences of residuals, weighted like those of the triplets.
            let residuals = |p: &Parameters| DVector::from_vec(squared_residuals(&data, p));
            let by: Vec<_> = (0..parameters.len())
                .map(|k| {
                    (residuals(&shifted(k, step)) - residuals(&shifted(k, -step))) / (2.0 * step)
                })
                .collect();
            for i in 0..by.len() {
                for j in 0..by.len() {
                    let expected = by[i].dot(&by[j]);
                    let scale = (by[i].norm_squared() * by[j].norm_squared()).sqrt();
                    assert!((normal.matrix[(i, j)] - expected).abs() < 1e-6 * scale, "{i}, {j}");
                }
            }
        }
    }
}
