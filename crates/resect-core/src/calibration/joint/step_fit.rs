//! Least-squares fit of a step: of a station's pose, or of its clock.

use nalgebra::{DMatrix, DVector, SMatrix, SVector, Vector3};

use super::prior_conflict::LEAST_INFORMATION;
use super::state_vector::{SLOW_CLOCKS, SLOW_RANGES};
use crate::calibration::Estimate;

/// States that may step: poses of stations 2 and 3, and their clocks.
pub const STEPPING: usize = SLOW_RANGES;

/// Jacobians of the slow states by a station's displacement and rotation (x, y, z, yaw), and by its clock offset.
pub fn step_jacobians(
    station: usize,
    positions_m: &[Vector3<f64>; 2],
) -> (SMatrix<f64, STEPPING, 4>, SMatrix<f64, STEPPING, 1>) {
    let mut by_pose = SMatrix::<f64, STEPPING, 4>::zeros();
    let mut by_clock = SMatrix::<f64, STEPPING, 1>::zeros();
    match station.checked_sub(1) {
        Some(slot) => {
            (0..4).for_each(|k| by_pose[(4 * slot + k, k)] = 1.0);
            by_clock[SLOW_CLOCKS + slot] = 1.0;
        }
        None => {
            for slot in 0..2 {
                (0..4).for_each(|k| by_pose[(4 * slot + k, k)] = -1.0);
                let by_yaw_m = Vector3::z().cross(&positions_m[slot]);
                by_pose.fixed_view_mut::<3, 1>(4 * slot, 3).copy_from(&-by_yaw_m);
                by_clock[SLOW_CLOCKS + slot] = -1.0;
            }
        }
    }
    (by_pose, by_clock)
}

/// Least-squares fit of a step's size: its χ² and its parameters; `None` without information.
///
/// `prior` are variances of the parameters. Directions about which the data says little beside them are not fitted, and keep them:
/// errors of the model that nothing else shows would be magnified there.
pub fn fit<const D: usize, const N: usize>(
    jacobian: &SMatrix<f64, D, N>,
    normal: &SMatrix<f64, D, D>,
    right: &SVector<f64, D>,
    prior: &SVector<f64, N>,
) -> Option<(f64, [Estimate; N])> {
    let root = prior.map(f64::sqrt);
    let own = jacobian.tr_mul(&(normal * jacobian));
    let scaled = DMatrix::from_fn(N, N, |i, j| own[(i, j)] * root[i] * root[j]);
    let right = jacobian.tr_mul(right).component_mul(&root);
    let right = DVector::from_column_slice(right.as_slice());
    let eigen = scaled.symmetric_eigen();
    let (mut chi_square, mut is_informed) = (0.0, false);
    let (mut size, mut variance) = (DVector::zeros(N), DVector::<f64>::zeros(N));
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        let informed = *value > LEAST_INFORMATION;
        if informed {
            let projected = vector.dot(&right);
            chi_square += projected * projected / value;
            size += vector * (projected / value);
        }
        is_informed |= informed;
        let own = if informed { value.recip() } else { 1.0 };
        variance += vector.component_mul(&vector) * own;
    }
    let estimate =
        |k: usize| Estimate { value: size[k] * root[k], sigma: variance[k].sqrt() * root[k] };
    is_informed.then(|| (chi_square, std::array::from_fn(estimate)))
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector4;

    use super::*;

    #[test]
    fn a_rotation_of_station_1_is_the_opposite_one_of_the_others() {
        let positions_m = [Vector3::new(10.0, 0.0, 0.0), Vector3::new(0.0, 20.0, 0.0)];
        let (by_pose, by_clock) = step_jacobians(0, &positions_m);
        let slow = by_pose * Vector4::new(0.0, 0.0, 0.0, 1e-3);
        assert!((slow.fixed_rows::<3>(0) - Vector3::new(0.0, -0.01, 0.0)).norm() < 1e-12, "{slow}");
        assert!((slow.fixed_rows::<3>(4) - Vector3::new(0.02, 0.0, 0.0)).norm() < 1e-12, "{slow}");
        assert_eq!((slow[3], slow[7]), (-1e-3, -1e-3));
        assert_eq!((by_clock[8], by_clock[9]), (-1.0, -1.0));
    }
}
