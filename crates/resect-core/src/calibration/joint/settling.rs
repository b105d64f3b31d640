//! Priors of how stations settle: random walks of stations 2, 3, … relative to station 1, which settles as well.

use nalgebra::{DMatrix, Matrix4, Vector3, Vector4};

use super::state_vector::Constants;
use crate::calibration::ErrorSizes;

/// Variance of the random walks of (x, y, z, yaw) of some slots relative to station 1 over a drive (m², rad²).
pub fn relative_settling(sizes: &ErrorSizes, mean: &Constants, slots: usize) -> DMatrix<f64> {
    let (own, by_station_1) = (own_settling(sizes), jacobian_by_station_1(mean, slots));
    let each = DMatrix::from_fn(4 * slots, 4 * slots, |i, j| if i == j { own[i % 4] } else { 0.0 });
    // (10)
    each + &by_station_1 * Matrix4::from_diagonal(&own) * by_station_1.transpose()
}

/// Returns the regression of station 1's own settling (x, y, z, yaw; m, rad) on the relative one, and the variance that remains after
/// a whole drive: of the independent random walks of all stations only the differences are observed.
pub fn station_1_by_relative(
    sizes: &ErrorSizes,
    mean: &Constants,
    slots: usize,
) -> (DMatrix<f64>, Matrix4<f64>) {
    let own = Matrix4::from_diagonal(&own_settling(sizes));
    let covariance = own * jacobian_by_station_1(mean, slots).transpose();
    let Some(relative) = relative_settling(sizes, mean, slots).cholesky() else {
        return (DMatrix::zeros(4, 4 * slots), own);
    };
    let regression = &covariance * relative.inverse();
    let explained = &regression * covariance.transpose();
    (DMatrix::from_column_slice(4, 4 * slots, regression.as_slice()), own - explained)
}

/// Variance of one station's random walk over a drive, along x, y, z (m²) and about z (rad²).
pub fn own_settling(sizes: &ErrorSizes) -> Vector4<f64> {
    let [position_m2, yaw_rad2] = [sizes.settling_m, sizes.settling_rad].map(|size| size.powi(2));
    Vector4::new(position_m2, position_m2, position_m2, yaw_rad2)
        .map(|variance| variance.max(1e-14))
}

/// Jacobian of the poses of the slots in station 1's frame by a displacement and rotation of station 1.
fn jacobian_by_station_1(mean: &Constants, slots: usize) -> DMatrix<f64> {
    let mut jacobian = DMatrix::zeros(4 * slots, 4);
    for slot in 0..slots {
        let position: Vector3<f64> = mean.fixed_rows::<3>(4 * slot).into();
        let mut moved = Matrix4::identity();
        moved.fixed_view_mut::<3, 1>(0, 3).copy_from(&Vector3::z().cross(&position));
        jacobian.fixed_view_mut::<4, 4>(4 * slot, 0).copy_from(&-moved);
    }
    jacobian
}
