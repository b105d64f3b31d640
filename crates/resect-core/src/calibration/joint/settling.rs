//! Priors of how stations settle: random walks of stations 2 and 3 relative to station 1, which settles as well.

use nalgebra::{Matrix4, SMatrix, SVector, Vector3, Vector4};

use super::state_vector::Constants;
use crate::calibration::ErrorSizes;

/// Variance of the random walks of (x, y, z, yaw) of stations 2 and 3 relative to station 1 over a drive (m², rad²).
pub fn relative_settling(sizes: &ErrorSizes, mean: &Constants) -> SMatrix<f64, 8, 8> {
    let (own, by_station_1) = (own_settling(sizes), jacobian_by_station_1(mean));
    let both = SVector::<f64, 8>::from_fn(|k, _| own[k % 4]);
    // (10)
    SMatrix::from_diagonal(&both)
        + by_station_1 * Matrix4::from_diagonal(&own) * by_station_1.transpose()
}

/// Returns the regression of station 1's own settling (x, y, z, yaw; m, rad) on the relative one, and the variance that remains after
/// a whole drive: of three independent random walks only two differences are observed.
pub fn station_1_by_relative(
    sizes: &ErrorSizes,
    mean: &Constants,
) -> (SMatrix<f64, 4, 8>, Matrix4<f64>) {
    let own = Matrix4::from_diagonal(&own_settling(sizes));
    let covariance = own * jacobian_by_station_1(mean).transpose();
    let Some(relative) = relative_settling(sizes, mean).cholesky() else {
        return (SMatrix::zeros(), own);
    };
    let regression = covariance * relative.inverse();
    (regression, own - regression * covariance.transpose())
}

/// Variance of one station's random walk over a drive, along x, y, z (m²) and about z (rad²).
pub fn own_settling(sizes: &ErrorSizes) -> Vector4<f64> {
    let [position_m2, yaw_rad2] = [sizes.settling_m, sizes.settling_rad].map(|size| size.powi(2));
    Vector4::new(position_m2, position_m2, position_m2, yaw_rad2)
        .map(|variance| variance.max(1e-14))
}

/// Jacobian of the poses of stations 2 and 3 in station 1's frame by a displacement and rotation of station 1.
fn jacobian_by_station_1(mean: &Constants) -> SMatrix<f64, 8, 4> {
    let mut jacobian = SMatrix::<f64, 8, 4>::zeros();
    for slot in 0..2 {
        let position: Vector3<f64> = mean.fixed_rows::<3>(4 * slot).into();
        let mut moved = Matrix4::identity();
        moved.fixed_view_mut::<3, 1>(0, 3).copy_from(&Vector3::z().cross(&position));
        jacobian.fixed_rows_mut::<4>(4 * slot).copy_from(&-moved);
    }
    jacobian
}
