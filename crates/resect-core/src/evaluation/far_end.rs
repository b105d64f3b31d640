//! Standard deviation of a prism's position at the far end of the track, by the calibration alone.
//!
//! σ of a translation and of a yaw mean little by themselves, because they cancel or add up with the distance to the prism. A
//! user can set a limit to the error with which a calibrated station positions a prism.

use nalgebra::{DMatrix, Matrix3x4, Vector3};

use crate::geometry::RigidTransform;
use crate::network::PerStation;

/// The point of the track with the largest standard deviation by the calibration alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FarEnd {
    /// The station, from 1 on.
    pub station: usize,
    /// Position of its prism in the frame of station 1 (m).
    pub position_m: Vector3<f64>,
    /// Root mean square error of that position (m), from the covariance of the station's transform alone.
    pub sigma_m: f64,
}

/// Finds the point at which a station other than the first positions its prism with the largest standard deviation.
///
/// `covariance` is that of (x, y, z, yaw) of stations 2, 3, … (m, rad). `points_m` are the prisms of the track in the frames of
/// their own stations (m), as in [`crate::pipeline::Triplets::points_m`]. `None` without points, or if a σ is not a number.
///
/// A point q of station s has p = R(ψ) q + t, whose covariance is J Σ Jᵀ with J = (I, ∂R/∂ψ q).
pub fn far_end(
    station1_from_station: &PerStation<RigidTransform>,
    covariance: &DMatrix<f64>,
    points_m: &PerStation<Vec<Vector3<f64>>>,
) -> Option<FarEnd> {
    let mut worst: Option<FarEnd> = None;
    for (station, points_m) in points_m.iter().enumerate().skip(1) {
        let transform = &station1_from_station[station];
        let of_station = covariance.fixed_view::<4, 4>(4 * (station - 1), 4 * (station - 1));
        for point_m in points_m {
            let turned_m = transform.rotate(point_m);
            let mut jacobian = Matrix3x4::identity();
            jacobian.set_column(3, &Vector3::new(-turned_m.y, turned_m.x, 0.0));
            let sigma_m = (jacobian * of_station * jacobian.transpose()).trace().sqrt();
            if sigma_m.is_finite() && worst.is_none_or(|worst| sigma_m > worst.sigma_m) {
                let position_m = turned_m + transform.translation_m;
                worst = Some(FarEnd { station, position_m, sigma_m });
            }
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::*;
    use crate::geometry::LevelTransform;

    #[test]
    fn a_yaw_counts_by_the_distance_and_may_cancel_with_a_translation() {
        let yaw_rad = 1.0;
        let level = LevelTransform::new(Vector3::new(5.0, -3.0, 0.2), yaw_rad);
        let transforms: PerStation<RigidTransform> =
            [RigidTransform::IDENTITY, RigidTransform::from(level), RigidTransform::IDENTITY]
                .into();
        let points_m: PerStation<Vec<Vector3<f64>>> =
            [vec![], vec![Vector3::new(10.0, 0.0, 1.0), Vector3::new(60.0, 0.0, 1.0)], vec![]]
                .into();
        // Only the yaw is uncertain, by 1 mrad: 60 mm at 60 m.
        let mut open = DVector::zeros(8);
        open[3] = 1e-3;
        let found = far_end(&transforms, &(&open * open.transpose()), &points_m).expect("points");
        assert_eq!(found.station, 1);
        assert!((found.sigma_m - 0.06).abs() < 1e-12, "{found:?}");
        assert!((found.position_m - level.apply(&points_m[1][1])).norm() < 1e-12);
        // With a rotation about the far point, the near one is uncertain.
        let back_m = -level.rotate(&Vector3::new(0.0, 60.0, 0.0)) * 1e-3;
        open.fixed_rows_mut::<3>(0).copy_from(&back_m);
        let found = far_end(&transforms, &(&open * open.transpose()), &points_m).expect("points");
        assert!((found.sigma_m - 0.05).abs() < 1e-12, "{found:?}");
        assert!((found.position_m - level.apply(&points_m[1][0])).norm() < 1e-12);
        assert_eq!(far_end(&transforms, &DMatrix::zeros(8, 8), &Default::default()), None);
    }
}
