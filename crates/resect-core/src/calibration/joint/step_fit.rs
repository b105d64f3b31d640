//! Least-squares fit of a step: of a station's pose, or of its clock.

use nalgebra::{DMatrix, DVector, Vector3};

use super::prior_conflict::LEAST_INFORMATION;
use super::state_vector::{Constants, Layout};
use crate::calibration::Estimate;
use crate::network::Station;

/// Jacobians of the states that may step, poses and clocks by slot: by a station's displacement and rotation (x, y, z, yaw), and by its
/// clock offset.
pub fn step_jacobians(
    layout: &Layout,
    station: Station,
    constants: &Constants,
) -> (DMatrix<f64>, DMatrix<f64>) {
    let mut by_pose = DMatrix::zeros(layout.slow_ranges(), 4);
    let mut by_clock = DMatrix::zeros(layout.slow_ranges(), 1);
    match station.slot() {
        Some(slot) => {
            by_pose.fixed_view_mut::<4, 4>(4 * slot, 0).fill_with_identity();
            by_clock[layout.slow_clocks() + slot] = 1.0;
        }
        None => {
            for slot in 0..layout.moved() {
                (0..4).for_each(|k| by_pose[(4 * slot + k, k)] = -1.0);
                let position_m: Vector3<f64> = constants.fixed_rows::<3>(4 * slot).into();
                let by_yaw_m = Vector3::z().cross(&position_m);
                by_pose.fixed_view_mut::<3, 1>(4 * slot, 3).copy_from(&-by_yaw_m);
                by_clock[layout.slow_clocks() + slot] = -1.0;
            }
        }
    }
    (by_pose, by_clock)
}

/// Least-squares fit of a step's size: its χ² and its parameters; `None` without information.
///
/// `prior` are variances of the parameters. Directions about which the data says little beside them are not fitted, and keep them:
/// errors of the model that nothing else shows would be magnified there.
pub fn fit(
    jacobian: &DMatrix<f64>,
    normal: &DMatrix<f64>,
    right: &DVector<f64>,
    prior: &[f64],
) -> Option<(f64, Vec<Estimate>)> {
    let root = DVector::from_iterator(prior.len(), prior.iter().map(|variance| variance.sqrt()));
    let size = root.len();
    let own = jacobian.tr_mul(&(normal * jacobian));
    let scaled = DMatrix::from_fn(size, size, |i, j| own[(i, j)] * root[i] * root[j]);
    let right = jacobian.tr_mul(right).component_mul(&root);
    let eigen = scaled.symmetric_eigen();
    let (mut chi_square, mut is_informed) = (0.0, false);
    let (mut value, mut variance) = (DVector::zeros(size), DVector::<f64>::zeros(size));
    for (eigenvalue, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        let informed = *eigenvalue > LEAST_INFORMATION;
        if informed {
            let projected = vector.dot(&right);
            chi_square += projected * projected / eigenvalue;
            value += vector * (projected / eigenvalue);
        }
        is_informed |= informed;
        let own = if informed { eigenvalue.recip() } else { 1.0 };
        variance += vector.component_mul(&vector) * own;
    }
    let estimate =
        |k: usize| Estimate { value: value[k] * root[k], sigma: variance[k].sqrt() * root[k] };
    is_informed.then(|| (chi_square, (0..size).map(estimate).collect()))
}

/// Normal matrix and right-hand side that has further errors.
///
/// The right-hand side has the covariance N; with that of further errors E, the generalised least squares have `N (N + E)⁻¹ N` and
/// `N (N + E)⁻¹ r`.
pub fn with_errors(
    normal: DMatrix<f64>,
    right: DVector<f64>,
    errors: &DMatrix<f64>,
) -> (DMatrix<f64>, DVector<f64>) {
    let factor = (&normal + errors).lu();
    match factor.solve(&normal).zip(factor.solve(&right)) {
        Some((by_normal, by_right)) => (&normal * by_normal, &normal * by_right),
        None => (normal, right),
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector4;

    use super::super::state_vector::tests::layout;
    use super::*;

    #[test]
    fn a_rotation_of_station_1_is_the_opposite_one_of_the_others() {
        let layout = layout(3);
        let mut constants = DVector::zeros(layout.constants);
        (constants[0], constants[5]) = (10.0, 20.0);
        let (by_pose, by_clock) = step_jacobians(&layout, Station::FIRST, &constants);
        let slow = by_pose * Vector4::new(0.0, 0.0, 0.0, 1e-3);
        assert!((slow.fixed_rows::<3>(0) - Vector3::new(0.0, -0.01, 0.0)).norm() < 1e-12, "{slow}");
        assert!((slow.fixed_rows::<3>(4) - Vector3::new(0.02, 0.0, 0.0)).norm() < 1e-12, "{slow}");
        assert_eq!((slow[3], slow[7]), (-1e-3, -1e-3));
        assert_eq!((by_clock[8], by_clock[9]), (-1.0, -1.0));
    }
}
