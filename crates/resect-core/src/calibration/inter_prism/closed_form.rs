//! Prior without an initial guess: a lifted linear least-squares problem for each pair with station 1.
//!
//! For one pair, ‖q1 − R q − t‖² = d² is linear in (cos ψ, sin ψ, tx, ty, tz, ‖t‖², (Rᵀt)x, (Rᵀt)y). Without the constraints
//! between these, it is an ordinary least-squares problem, solved by SVD of the compressed triplets ([`super::compression`]). It
//! determines the yaw and the horizontal translation. On level ground tz is nearly collinear with ‖t‖². The height is therefore
//! computed from the problem with the rest fixed: a quartic in tz, whose two minima are the solution and its mirror twin.

use nalgebra::{Matrix3, SMatrix, SVector};

use super::compression::{CONSTANT, Factor};
use super::{Parameters, SquaredCost};
use crate::network::Station;

/// Singular values below this fraction of the largest are zero.
const RANK_TOLERANCE: f64 = 1e-9;

/// Returns one prior for each combination of the height solutions of the pairs with station 1: up to two to the power of their
/// number.
pub fn closed_form_priors(cost: &SquaredCost) -> Vec<Parameters> {
    let mut priors: Vec<Vec<f64>> = vec![Vec::new()];
    for station in cost.network.unknown_stations() {
        let poses = poses(cost, station);
        priors = (priors.iter())
            .flat_map(|prior| poses.iter().map(move |pose| [prior, &pose[..]].concat()))
            .collect();
    }
    priors.into_iter().map(Parameters::from_vec).collect()
}

/// Returns one or two poses (x, y, z, yaw) of a station's centred frame by its pair with station 1.
fn poses(cost: &SquaredCost, station: Station) -> Vec<[f64; 4]> {
    let Some(index) = cost.network.index_of(Station::FIRST, station) else {
        return vec![[0.0; 4]];
    };
    let factor = cost.factor(index);
    if cost.network.pairs[index].is_shared() {
        return vec![shared_prism_pose(&factor)];
    }
    pair_solutions(&factor)
}

/// Returns the pose of a station that follows the prism of station 1: the alignment of two tracks about their centroids.
///
/// The cost is 2 (cos ψ g₀ + sin ψ g₁) and a constant, with the products g of columns of the triangle.
fn shared_prism_pose(factor: &Factor) -> [f64; 4] {
    let [by_cos, by_sin] =
        [0, 1].map(|column| SVector::from(factor[column]).dot(&SVector::from(factor[CONSTANT])));
    [0.0, 0.0, 0.0, (-by_sin).atan2(-by_cos)]
}

/// Returns one or two poses (x, y, z, yaw) of a station's centred frame, which differ in z.
fn pair_solutions(factor: &Factor) -> Vec<[f64; 4]> {
    let mut triangle = SMatrix::<f64, 8, 8>::from_fn(|row, column| factor[column][row]);
    let right = SVector::<f64, 8>::from_fn(|row, _| -factor[CONSTANT][row]);
    // The matrix mixes metres, square metres and ones: the columns are scaled before the rank is computed.
    let scales = SVector::<f64, 8>::from_fn(|k, _| triangle.column(k).norm().max(1e-12));
    for k in 0..8 {
        triangle.column_mut(k).unscale_mut(scales[k]);
    }
    // An SVD of the small triangular factor is as accurate as one of the tall matrix.
    let Some(svd) = triangle.try_svd(true, true, f64::EPSILON, 500) else {
        return vec![[0.0; 4]];
    };
    let Ok(solution) = svd.solve(&right, RANK_TOLERANCE * svd.singular_values.max()) else {
        return vec![[0.0; 4]];
    };
    let solution = solution.component_div(&scales);
    let (x, y, yaw) = (solution[2], solution[3], solution[1].atan2(solution[0]));
    height_solutions(factor, x, y, yaw).into_iter().map(|z| [x, y, z, yaw]).collect()
}

/// Returns the heights that minimise the squared-distance cost with the rest fixed.
///
/// The monomials are linear in z and z², so the cost is ‖r0 + z r1 + z² r2‖² and its derivative is a cubic.
fn height_solutions(factor: &Factor, x: f64, y: f64, yaw: f64) -> Vec<f64> {
    let (sin, cos) = yaw.sin_cos();
    let at_zero = SVector::from([
        cos,
        sin,
        x,
        y,
        0.0,
        x * x + y * y,
        cos * x + sin * y,
        cos * y - sin * x,
        1.0,
    ]);
    let [r1, r2] = [4, 5].map(|column| SVector::from(factor[column]));
    let r0 = SMatrix::<f64, 9, 9>::from_fn(|row, column| factor[column][row]) * at_zero;
    // z³ + a z² + b z + c = 0, as the eigenvalues of its companion matrix.
    let leading = 2.0 * r2.norm_squared();
    let (a, b, c) = (
        3.0 * r1.dot(&r2) / leading,
        (r1.norm_squared() + 2.0 * r0.dot(&r2)) / leading,
        r0.dot(&r1) / leading,
    );
    let companion = Matrix3::new(-a, -b, -c, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
    let mut real: Vec<f64> = companion
        .complex_eigenvalues()
        .iter()
        .filter(|root| root.im.abs() < 1e-9 * (1.0 + root.re.abs()))
        .map(|root| root.re)
        .collect();
    real.sort_by(f64::total_cmp);
    match real[..] {
        [low, _, high] => vec![low, high],
        [low, high] => vec![low, high],
        [only] => vec![only],
        _ => vec![-a / 3.0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::inter_prism::{CentredTriplets, PrismNetwork};
    use crate::geometry::LevelTransform;
    use crate::pipeline::Triplets;
    use nalgebra::{Rotation3, Vector3};

    #[test]
    fn exact_data_gives_the_truth_without_a_guess() {
        let truth = [
            LevelTransform::IDENTITY,
            LevelTransform::new(Vector3::new(5.0, -2.5, -0.3), 2.6),
            LevelTransform::new(Vector3::new(-5.5, 0.3, -0.2), -1.9),
        ];
        let rig = [
            Vector3::new(0.0, 0.0, 0.4),
            Vector3::new(0.6, 0.3, 0.0),
            Vector3::new(-0.1, 0.8, 0.1),
        ];
        let mut points: [Vec<Vector3<f64>>; 3] = Default::default();
        for i in 0..200 {
            let s = f64::from(i) * 0.07;
            let turn =
                Rotation3::from_euler_angles(0.1 * (1.3 * s).sin(), 0.1 * (0.9 * s).cos(), 1.1 * s);
            let middle =
                Vector3::new(20.0 + 9.0 * s.sin(), 8.0 * (0.6 * s).cos(), 0.4 * (0.5 * s).sin());
            for station in 0..3 {
                let placed = middle + turn * rig[station];
                points[station].push(truth[station].inverse().apply(&placed));
            }
        }
        let distances = crate::deployment::pairwise_distances(&rig);
        let triplets = Triplets::new(vec![0.0; 200], vec![0; 200], points);
        let data = CentredTriplets::new(&triplets, &PrismNetwork::of_own_prisms(distances));
        let best = closed_form_priors(&SquaredCost::of(&data))
            .iter()
            .map(|prior| data.transforms(prior))
            .map(|found| {
                (1..3)
                    .map(|s| (found[s].translation_m - truth[s].translation_m).norm())
                    .fold(0.0, f64::max)
            })
            .fold(f64::INFINITY, f64::min);
        assert!(best < 1e-5, "off by {best} m");
    }
}
