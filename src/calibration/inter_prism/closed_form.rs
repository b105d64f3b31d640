//! The prior without a guess: a lifted linear least squares for each pair with station 1.
//!
//! For one pair, ‖q1 − R q − t‖² = d² is linear in (cos ψ, sin ψ, tx, ty, tz, ‖t‖², (Rᵀt)x, (Rᵀt)y). Forgetting
//! how these depend on each other leaves an ordinary least-squares problem, solved by SVD on centred
//! coordinates (a Gram matrix would square their condition). It gives the yaw and the horizontal translation;
//! on level ground tz is all but collinear with ‖t‖², so the height comes from what is left of the problem
//! once the rest is known: a quartic in tz, whose two minima are the solution and its mirror twin.

use nalgebra::{DMatrix, DVector, Matrix3};

use super::{CentredTriplets, Parameters};

/// Singular values below this fraction of the largest carry no information.
const RANK_TOLERANCE: f64 = 1e-9;

/// One prior for each combination of the two pairs' height solutions, one to four.
pub fn closed_form_priors(data: &CentredTriplets) -> Vec<Parameters> {
    let [of_2, of_3] = [0, 1].map(|slot| pair_solutions(data, slot));
    let mut priors = Vec::with_capacity(of_2.len() * of_3.len());
    for a in &of_2 {
        for b in &of_3 {
            priors.push(Parameters::from_column_slice(&[
                a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3],
            ]));
        }
    }
    priors
}

/// (x, y, z, yaw) of a station's centred frame, one or two that differ in z.
fn pair_solutions(data: &CentredTriplets, slot: usize) -> Vec<[f64; 4]> {
    let d2 = data.inter_prism_m[slot].powi(2);
    let [ax, ay, az] = &data.coordinates[0];
    let [bx, by, bz] = &data.coordinates[slot + 1];
    let count = data.len();
    let mut rows = DMatrix::<f64>::zeros(count, 8);
    let mut right = DVector::<f64>::zeros(count);
    for i in 0..count {
        let squares = ax[i] * ax[i] + ay[i] * ay[i] + bx[i] * bx[i] + by[i] * by[i];
        let dz = az[i] - bz[i];
        let row = [
            -2.0 * (ax[i] * bx[i] + ay[i] * by[i]),
            -2.0 * (ay[i] * bx[i] - ax[i] * by[i]),
            -2.0 * ax[i],
            -2.0 * ay[i],
            -2.0 * dz,
            1.0,
            2.0 * bx[i],
            2.0 * by[i],
        ];
        for (column, value) in row.into_iter().enumerate() {
            rows[(i, column)] = value;
        }
        right[i] = d2 - squares - dz * dz;
    }
    // Metres, square metres and ones in one matrix: scale the columns before the rank is judged.
    let scales: Vec<f64> = (0..8).map(|column| rows.column(column).norm().max(1e-12)).collect();
    for (column, scale) in scales.iter().enumerate() {
        rows.column_mut(column).unscale_mut(*scale);
    }
    // An SVD of the small triangular factor is as good as one of the tall matrix.
    let qr = rows.qr();
    let mut projected = right;
    qr.q_tr_mul(&mut projected);
    let Some(small) = qr.r().try_svd(true, true, f64::EPSILON, 500) else {
        return vec![[0.0; 4]];
    };
    let tolerance = RANK_TOLERANCE * small.singular_values.max();
    let size = small.singular_values.len();
    let Ok(mut solution) = small.solve(&projected.rows(0, size).into_owned(), tolerance) else {
        return vec![[0.0; 4]];
    };
    for (value, scale) in solution.iter_mut().zip(&scales) {
        *value /= scale;
    }
    let (x, y, yaw) = (solution[2], solution[3], solution[1].atan2(solution[0]));
    height_solutions(data, slot, x, y, yaw).into_iter().map(|z| [x, y, z, yaw]).collect()
}

/// Heights that make the squared-distance cost stationary and lowest, the rest being known.
///
/// Σ ((dz−z)² − g)² with dz = z1 − z_b and g = d² − (horizontal distance)²; its derivative is a cubic.
fn height_solutions(data: &CentredTriplets, slot: usize, x: f64, y: f64, yaw: f64) -> Vec<f64> {
    let (sin, cos) = yaw.sin_cos();
    let [ax, ay, az] = &data.coordinates[0];
    let [bx, by, bz] = &data.coordinates[slot + 1];
    let n = data.len() as f64;
    let (mut s1, mut s2, mut s3, mut sg, mut sgz) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for i in 0..data.len() {
        let ex = ax[i] - (cos * bx[i] - sin * by[i]) - x;
        let ey = ay[i] - (sin * bx[i] + cos * by[i]) - y;
        let dz = az[i] - bz[i];
        let g = data.inter_prism_m[slot].powi(2) - ex * ex - ey * ey;
        s1 += dz;
        s2 += dz * dz;
        s3 += dz * dz * dz;
        sg += g;
        sgz += g * dz;
    }
    // z³ + a z² + b z + c = 0, as the eigenvalues of its companion matrix.
    let (a, b, c) = (-3.0 * s1 / n, (3.0 * s2 - sg) / n, (sgz - s3) / n);
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
        _ => vec![s1 / n],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
        let distances = crate::deployment::PAIRS.map(|(a, b)| (rig[a] - rig[b]).norm());
        let triplets = Triplets::new(vec![0.0; 200], vec![0; 200], points);
        let data = CentredTriplets::new(&triplets, distances);
        let best = closed_form_priors(&data)
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
