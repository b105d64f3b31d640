//! Cost, gradient and Gauss–Newton matrix of method D, in one pass over the data.
//!
//! For a pair with difference e = T_a q_a − T_b q_b, distance ‖e‖ and unit vector u = e/‖e‖, the residual is r = ‖e‖ − d. The
//! derivatives of r are ±u for a translation and ±u·(dR/dψ q) for a yaw. A pair of stations that follow the same prism has the
//! three coordinates of e as residuals. The sums for the normal matrix ([`super::pair_sums`]) are accumulated per pair, as
//! `[f64; LANES]` each, so that the compiler vectorises the inner loops. `multiversion` selects AVX-512 or AVX2 if the processor
//! has it.

use std::ops::Range;

use multiversion::multiversion;

use super::normal_equations::NormalEquations;
use super::pair_sums::{PairRows, PairSums};
use super::prism_network::{FollowedPair, UNKNOWNS_PER_STATION};
use super::{CentredTriplets, Parameters};
use crate::network::Number;

impl NormalEquations {
    /// Returns the normal equations of the distances (Vaidis et al. 2022, eq. (3)).
    pub fn at(data: &CentredTriplets, parameters: &Parameters) -> Self {
        Self::over(data, parameters, 0..data.len())
    }

    /// Returns the normal equations of the distances of some of the triplets.
    pub fn over(data: &CentredTriplets, parameters: &Parameters, instants: Range<usize>) -> Self {
        let mut normal = Self::zeros(parameters.len());
        normal.evaluate(data, parameters, instants);
        normal
    }

    /// Replaces these by the normal equations of the distances of some of the triplets.
    pub fn evaluate(
        &mut self,
        data: &CentredTriplets,
        parameters: &Parameters,
        instants: Range<usize>,
    ) {
        self.clear();
        let sums = sums_over(data, parameters, instants);
        for (pair, sums) in data.network.pairs.iter().zip(&sums) {
            sums.add_to(pair.stations, self);
        }
        self.matrix.fill_lower_triangle_with_upper_triangle();
    }
}

fn sums_over(
    data: &CentredTriplets,
    parameters: &Parameters,
    instants: Range<usize>,
) -> Vec<PairSums<1>> {
    let mut points: Vec<[&[f64]; 3]> = Vec::with_capacity(data.network.stations());
    for station in &data.coordinates {
        points.push(station.each_ref().map(|axis| &axis[instants.clone()]));
    }
    let unknowns = parameters.as_slice().chunks_exact(UNKNOWNS_PER_STATION);
    let poses: Vec<CentredPose> = unknowns.map(CentredPose::of).collect();
    sum(&points, &poses, &data.network.pairs)
}

/// Pose of a station's centred frame.
#[derive(Clone, Copy)]
struct CentredPose {
    x: f64,
    y: f64,
    z: f64,
    sin: f64,
    cos: f64,
}

impl CentredPose {
    fn of(p: &[f64]) -> Self {
        let (sin, cos) = p[3].sin_cos();
        Self { x: p[0], y: p[1], z: p[2], sin, cos }
    }
}

const LANES: usize = 8;
/// Instants that are placed together: few enough for the first-level cache with eight stations.
const TILE: usize = 64;

// Code inside `sum` consists of plain loops in functions that are always inlined: closures and iterators would be compiled for the
// oldest processor.

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
fn sum(points: &[[&[f64]; 3]], poses: &[CentredPose], pairs: &[FollowedPair]) -> Vec<PairSums<1>> {
    let count = points[0][0].len();
    let whole = count / LANES * LANES;
    let mut placed = vec![PlacedPrisms::ZERO; points.len()];
    let mut wide = vec![PairSums::<LANES>::ZERO; pairs.len()];
    let mut start = 0;
    while start < whole {
        let end = if whole - start < TILE { whole } else { start + TILE };
        place(points, poses, start..end, &mut placed);
        add::<LANES>(&placed, end - start, pairs, &mut wide);
        start = end;
    }
    let mut total = Vec::with_capacity(pairs.len());
    for sums in &wide {
        total.push(sums.fold());
    }
    place(points, poses, whole..count, &mut placed);
    add::<1>(&placed, count - whole, pairs, &mut total);
    total
}

/// Prism positions of one station in station 1's frame at some instants (m).
#[derive(Clone, Copy)]
struct PlacedPrisms {
    position: [[f64; TILE]; 3],
    /// Derivative of x and y with respect to the station's yaw; z has none.
    by_yaw: [[f64; TILE]; 2],
}

impl PlacedPrisms {
    const ZERO: Self = Self { position: [[0.0; TILE]; 3], by_yaw: [[0.0; TILE]; 2] };
}

/// Transforms the points of all stations at some instants to station 1's frame.
#[inline(always)]
fn place(
    points: &[[&[f64]; 3]],
    poses: &[CentredPose],
    instants: Range<usize>,
    placed: &mut [PlacedPrisms],
) {
    for axis in 0..3 {
        let own = &points[0][axis][instants.start..instants.end];
        placed[0].position[axis][..own.len()].copy_from_slice(own);
    }
    for slot in 0..poses.len() {
        let pose = poses[slot];
        let x = &points[slot + 1][0][instants.start..instants.end];
        let y = &points[slot + 1][1][instants.start..instants.end];
        let z = &points[slot + 1][2][instants.start..instants.end];
        let PlacedPrisms { position, by_yaw } = &mut placed[slot + 1];
        for i in 0..x.len().min(TILE) {
            let (rx, ry) = (pose.cos * x[i] - pose.sin * y[i], pose.sin * x[i] + pose.cos * y[i]);
            position[0][i] = rx + pose.x;
            position[1][i] = ry + pose.y;
            position[2][i] = z[i] + pose.z;
            by_yaw[0][i] = -ry;
            by_yaw[1][i] = rx;
        }
    }
}

/// Adds the first `count` placed instants, a multiple of `L`, to the sums of each pair.
#[inline(always)]
fn add<const L: usize>(
    placed: &[PlacedPrisms],
    count: usize,
    pairs: &[FollowedPair],
    sums: &mut [PairSums<L>],
) {
    for (pair, sums) in pairs.iter().zip(sums) {
        let a = &placed[pair.stations.first.index()];
        let b = &placed[pair.stations.second.index()];
        let is_first = pair.stations.first.index() == 0;
        if pair.is_shared() {
            add_vectors::<L>(a, b, count, !is_first, sums);
        } else if is_first {
            add_distances::<L, false>(a, b, count, pair.distance_m, sums);
        } else {
            add_distances::<L, true>(a, b, count, pair.distance_m, sums);
        }
    }
}

/// Adds the distances of one pair of stations; `MOVING` is true if station a has unknowns too.
#[inline(always)]
fn add_distances<const L: usize, const MOVING: bool>(
    station_a: &PlacedPrisms,
    station_b: &PlacedPrisms,
    count: usize,
    distance_m: f64,
    sums: &mut PairSums<L>,
) {
    let mut start = 0;
    while start < count {
        let at_a: [[f64; L]; 3] = lanes(&station_a.position, start);
        let at_b: [[f64; L]; 3] = lanes(&station_b.position, start);
        let turned_a: [[f64; L]; 2] = lanes(&station_a.by_yaw, start);
        let turned_b: [[f64; L]; 2] = lanes(&station_b.by_yaw, start);
        let mut rows = PairRows { u: [[0.0; L]; 3], a: [0.0; L], b: [0.0; L], r: [0.0; L] };
        for l in 0..L {
            let e = [at_a[0][l] - at_b[0][l], at_a[1][l] - at_b[1][l], at_a[2][l] - at_b[2][l]];
            let norm = (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]).sqrt();
            // Coincident points have no direction; any finite one keeps the sums finite.
            let inverse = 1.0 / norm.max(1e-12);
            for axis in 0..3 {
                rows.u[axis][l] = e[axis] * inverse;
            }
            rows.r[l] = norm - distance_m;
            rows.a[l] = rows.u[0][l] * turned_a[0][l] + rows.u[1][l] * turned_a[1][l];
            rows.b[l] = rows.u[0][l] * turned_b[0][l] + rows.u[1][l] * turned_b[1][l];
        }
        sums.add(&rows, MOVING);
        start += L;
    }
}

/// Adds the vectors between the positions of one prism by two stations.
#[inline(always)]
fn add_vectors<const L: usize>(
    station_a: &PlacedPrisms,
    station_b: &PlacedPrisms,
    count: usize,
    moving: bool,
    sums: &mut PairSums<L>,
) {
    let mut start = 0;
    while start < count {
        let at_a: [[f64; L]; 3] = lanes(&station_a.position, start);
        let at_b: [[f64; L]; 3] = lanes(&station_b.position, start);
        let turned_a: [[f64; L]; 2] = lanes(&station_a.by_yaw, start);
        let turned_b: [[f64; L]; 2] = lanes(&station_b.by_yaw, start);
        for axis in 0..3 {
            let mut rows = PairRows { u: [[0.0; L]; 3], a: [0.0; L], b: [0.0; L], r: [0.0; L] };
            rows.u[axis] = [1.0; L];
            for l in 0..L {
                rows.r[l] = at_a[axis][l] - at_b[axis][l];
            }
            if axis < 2 {
                rows.a = turned_a[axis];
                rows.b = turned_b[axis];
            }
            sums.add(&rows, moving);
        }
        start += L;
    }
}

/// Returns `L` consecutive instants of each list.
#[inline(always)]
fn lanes<const N: usize, const L: usize>(lists: &[[f64; TILE]; N], start: usize) -> [[f64; L]; N] {
    let mut some = [[0.0; L]; N];
    for axis in 0..N {
        some[axis].copy_from_slice(&lists[axis][start..start + L]);
    }
    some
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::calibration::inter_prism::PrismNetwork;
    use crate::network::{PerPair, PerStation, Prism};
    use crate::pipeline::Triplets;
    use nalgebra::{DMatrix, DVector, Vector3};

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
        let network = PrismNetwork::of_own_prisms([0.7, 0.9, 1.1]);
        (CentredTriplets::new(&triplets, &network), parameters)
    }

    /// The same, where stations 2 and 3 follow the same prism, and so do stations 1 and 4.
    pub fn irregular_shared(count: usize) -> (CentredTriplets, Parameters) {
        let (three, parameters) = irregular(count);
        let points = |station: usize| -> Vec<Vector3<f64>> {
            let [x, y, z] = &three.coordinates[station];
            (0..count).map(|i| Vector3::new(x[i], y[i], z[i])).collect()
        };
        let fourth = points(1).into_iter().zip(points(2)).map(|(a, b)| 0.6 * a - b).collect();
        let points_m = [points(0), points(1), points(2), fourth];
        let prisms = PerStation::from([0, 1, 1, 0].map(Prism::at));
        let network = PrismNetwork::new(prisms, &PerPair::from([0.8]));
        let parameters = parameters.as_slice().iter().copied().chain([0.5, 0.9, -0.2, 0.8]);
        let parameters = Parameters::from_vec(parameters.collect());
        (CentredTriplets::from_points(points_m.into(), &network), parameters)
    }

    #[test]
    fn the_gradient_matches_numerical_differences() {
        for (data, parameters) in [irregular(29), irregular_shared(29)] {
            let normal = NormalEquations::at(&data, &parameters);
            for k in 0..parameters.len() {
                let step = 1e-6;
                let shifted = |by: f64| {
                    let mut p = parameters.clone();
                    p[k] += by;
                    NormalEquations::at(&data, &p).cost
                };
                let numerical = (shifted(step) - shifted(-step)) / (4.0 * step);
                let scale = normal.gradient.amax();
                assert!((numerical - normal.gradient[k]).abs() < 1e-6 * scale, "parameter {k}");
            }
        }
    }

    #[test]
    fn the_matrix_is_the_sum_of_outer_products() {
        for (data, parameters) in [irregular(13), irregular_shared(13)] {
            let normal = NormalEquations::at(&data, &parameters);
            let step = 1e-6;
            let rows: Vec<DVector<f64>> = (0..parameters.len())
                .map(|k| {
                    let residuals = |by: f64| {
                        let mut p = parameters.clone();
                        p[k] += by;
                        DVector::from_vec(residuals(&data, &p))
                    };
                    (residuals(step) - residuals(-step)) / (2.0 * step)
                })
                .collect();
            let expected = DMatrix::from_fn(rows.len(), rows.len(), |i, j| rows[i].dot(&rows[j]));
            assert!((&normal.matrix - &expected).amax() < 1e-7 * expected.amax());
            let cost: f64 = residuals(&data, &parameters).iter().map(|r| r * r).sum();
            assert!((normal.cost - cost).abs() < 1e-12 * cost);
        }
    }

    /// Returns all residuals (m), computed triplet by triplet.
    pub fn residuals(data: &CentredTriplets, parameters: &Parameters) -> Vec<f64> {
        let mut residuals = Vec::new();
        for i in 0..data.len() {
            let placed_m = data.placed_m(parameters, i);
            for pair in &data.network.pairs {
                let [a, b] = [pair.stations.first, pair.stations.second].map(|s| placed_m[s]);
                if pair.is_shared() {
                    residuals.extend((a - b).iter());
                } else {
                    residuals.push((a - b).norm() - pair.distance_m);
                }
            }
        }
        residuals
    }

    #[test]
    fn parts_add_up_to_the_whole_at_any_cut() {
        let (data, parameters) = irregular_shared(150);
        let whole = NormalEquations::at(&data, &parameters);
        for cut in [0, 1, 7, 8, 9, 36, 63, 64, 65, 128, 149, 150] {
            let left = NormalEquations::over(&data, &parameters, 0..cut);
            let right = NormalEquations::over(&data, &parameters, cut..150);
            let off = left.gradient + right.gradient - &whole.gradient;
            assert!(off.amax() < 1e-9 * whole.gradient.amax());
            let off = left.matrix + right.matrix - &whole.matrix;
            assert!(off.amax() < 1e-9 * whole.matrix.amax());
        }
    }
}
