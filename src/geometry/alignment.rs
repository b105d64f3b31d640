//! Point-to-point alignment of two lists of corresponding points.

use nalgebra::Vector3;

use super::LevelTransform;

/// The level transform that brings `points_b` closest to `points_a`, in the least-squares sense.
///
/// The paper's point-to-point cost (eq. `icp_p_to_point_min`) with roll and pitch held at zero, where
/// the minimum is closed: the centroids give the translation, and the yaw is the angle of the summed
/// horizontal cross and dot products (Umeyama 1991, in the plane).
/// Both slices hold metres, in corresponding order. `None` with fewer than two points.
pub fn align_level(points_a: &[Vector3<f64>], points_b: &[Vector3<f64>]) -> Option<LevelTransform> {
    if points_a.len() != points_b.len() || points_a.len() < 2 {
        return None;
    }
    let centroid =
        |points: &[Vector3<f64>]| points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    let (centre_a, centre_b) = (centroid(points_a), centroid(points_b));
    let (mut dot, mut cross) = (0.0, 0.0);
    for (a, b) in points_a.iter().zip(points_b) {
        let (a, b) = (a - centre_a, b - centre_b);
        dot += b.x * a.x + b.y * a.y;
        cross += b.x * a.y - b.y * a.x;
    }
    let turn = LevelTransform::new(Vector3::zeros(), cross.atan2(dot));
    Some(LevelTransform::new(centre_a - turn.rotate(&centre_b), turn.yaw_rad))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recovers_a_known_motion() {
        let truth = LevelTransform::new(Vector3::new(5.3, -2.5, -0.3), -0.52);
        let points_b: Vec<_> = (0..7)
            .map(|i| Vector3::new(f64::from(i * i), 3.0 * f64::from(i), 0.2 * f64::from(i % 3)))
            .collect();
        let points_a: Vec<_> = points_b.iter().map(|b| truth.apply(b)).collect();
        let found = align_level(&points_a, &points_b).expect("seven points");
        assert!((found.translation_m - truth.translation_m).norm() < 1e-10);
        assert!((found.yaw_rad - truth.yaw_rad).abs() < 1e-12);
    }

    #[test]
    fn one_point_is_not_enough() {
        assert_eq!(align_level(&[Vector3::zeros()], &[Vector3::zeros()]), None);
    }
}
