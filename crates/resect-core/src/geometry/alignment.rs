//! Point-to-point alignment of two lists of corresponding points.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::{LevelTransform, RigidTransform};

/// Least-squares level transform from `points_b` to `points_a`; `None` with fewer than two points.
///
/// The paper's point-to-point cost (eq. `icp_p_to_point_min`) with zero roll and pitch has a closed-form minimum. The centroids
/// give the translation, and the yaw is the angle of the summed horizontal cross and dot products (Umeyama 1991, in the plane).
/// Both slices are in metres, in corresponding order.
pub fn align_level(points_a: &[Vector3<f64>], points_b: &[Vector3<f64>]) -> Option<LevelTransform> {
    if points_a.len() != points_b.len() || points_a.len() < 2 {
        return None;
    }
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

/// Smallest singular value of an observable direction, relative to the largest. Singular values scale with the square of the
/// points' extent, so this is a width of a millionth of the length.
const NARROWEST: f64 = 1e-12;

/// Least-squares rigid transform from `points_b` to `points_a`.
///
/// Umeyama 1991 (eqs. 38–43) without the scale; see [`align_similar`]. Both slices are in metres, in corresponding order.
/// `None` if the rotation is not unique: fewer than three points, points on a line, or a mirror image whose two shorter extents
/// are equal. `None` too if a coordinate is not finite.
pub fn align_rigid(points_a: &[Vector3<f64>], points_b: &[Vector3<f64>]) -> Option<RigidTransform> {
    align_weighted(points_a, points_b, &vec![1.0; points_a.len()])
}

/// Least-squares rigid transform as [`align_rigid`], with a weight for each point.
pub fn align_weighted(
    points_a: &[Vector3<f64>],
    points_b: &[Vector3<f64>],
    weights: &[f64],
) -> Option<RigidTransform> {
    let (rotation, _) = turn_and_scale(points_a, points_b, weights)?;
    let translation_m = mean(points_a, weights) - rotation * mean(points_b, weights);
    Some(RigidTransform { rotation, translation_m })
}

/// Least-squares rigid transform from `points_b` to `points_a`, with the scale before it: a = R (s b) + t.
///
/// Umeyama 1991 (eqs. 38–43). Units, order and `None` as for [`align_rigid`].
pub fn align_similar(
    points_a: &[Vector3<f64>],
    points_b: &[Vector3<f64>],
) -> Option<(RigidTransform, f64)> {
    let (rotation, scale) = turn_and_scale(points_a, points_b, &vec![1.0; points_a.len()])?;
    let translation_m = centroid(points_a) - rotation * centroid(points_b) * scale;
    Some((RigidTransform { rotation, translation_m }, scale))
}

/// Rotation and scale by Umeyama 1991.
///
/// The singular value decomposition of the summed outer products a bᵀ about the centroids is U D Vᵀ. The rotation is
/// U diag(1, 1, det U det V) Vᵀ. Noise and points in a plane can fit a reflection better; the determinants exclude it.
fn turn_and_scale(
    points_a: &[Vector3<f64>],
    points_b: &[Vector3<f64>],
    weights: &[f64],
) -> Option<(Rotation3<f64>, f64)> {
    if points_a.len() != points_b.len() || points_a.len() != weights.len() {
        return None;
    }
    let (centre_a, centre_b) = (mean(points_a, weights), mean(points_b, weights));
    let spread: Matrix3<f64> = points_a
        .iter()
        .zip(points_b)
        .zip(weights)
        .map(|((a, b), weight)| *weight * (a - centre_a) * (b - centre_b).transpose())
        .sum();
    // The decomposition does not terminate on NaN or infinity. The squared norm overflows before it does, so the norm is checked.
    if !spread.norm_squared().is_finite() {
        return None;
    }
    let svd = spread.svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    let handedness = (u.determinant() * v_t.determinant()).signum();
    let [first, second, third] = svd.singular_values.into();
    // Fewer than three points are on a line too.
    if second + handedness * third <= NARROWEST * first {
        return None;
    }
    let rotation = u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, handedness)) * v_t;
    let sizes =
        points_b.iter().zip(weights).map(|(b, weight)| weight * (b - centre_b).norm_squared());
    let size_b: f64 = sizes.sum();
    let scale = (first + second + handedness * third) / size_b;
    Some((Rotation3::from_matrix_unchecked(rotation), scale))
}

fn mean(points: &[Vector3<f64>], weights: &[f64]) -> Vector3<f64> {
    let weighted = points.iter().zip(weights).map(|(point, weight)| *weight * point);
    weighted.sum::<Vector3<f64>>() / weights.iter().sum::<f64>()
}

fn centroid(points: &[Vector3<f64>]) -> Vector3<f64> {
    points.iter().sum::<Vector3<f64>>() / points.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

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

    fn vector() -> impl Strategy<Value = Vector3<f64>> {
        proptest::array::uniform3(-5.0..5.0f64).prop_map(Vector3::from)
    }

    fn motion() -> impl Strategy<Value = RigidTransform> {
        (vector(), vector()).prop_map(|(turn, translation_m)| RigidTransform {
            rotation: Rotation3::new(turn),
            translation_m: 10.0 * translation_m,
        })
    }

    /// Twice the area of the largest triangle of three points, over the square of its longest side.
    fn width(points: &[Vector3<f64>]) -> f64 {
        let (side, other) = (points[1] - points[0], points[2] - points[0]);
        let longest = side.norm().max(other.norm()).max((side - other).norm());
        side.cross(&other).norm() / longest.powi(2)
    }

    fn cost(
        a_from_b: &RigidTransform,
        points_a: &[Vector3<f64>],
        points_b: &[Vector3<f64>],
    ) -> f64 {
        points_a.iter().zip(points_b).map(|(a, b)| (a - a_from_b.apply(b)).norm_squared()).sum()
    }

    proptest! {
        #[test]
        fn a_rigid_motion_is_recovered(
            truth in motion(),
            points_b in proptest::collection::vec(vector(), 3..8),
        ) {
            prop_assume!(width(&points_b) > 0.05);
            let points_a: Vec<_> = points_b.iter().map(|b| truth.apply(b)).collect();
            let found = align_rigid(&points_a, &points_b).expect("three points off a line");
            prop_assert!((found.matrix() - truth.matrix()).norm() < 1e-9);
        }

        /// The result for any points, for which a reflection would often fit better, is a rotation. No small motion away from
        /// it is better.
        #[test]
        fn the_answer_is_a_rotation_and_a_minimum(
            points_a in proptest::collection::vec(vector(), 5),
            points_b in proptest::collection::vec(vector(), 5),
            step in vector(),
        ) {
            let found = align_rigid(&points_a, &points_b).expect("points off a line");
            let r = found.rotation.matrix();
            prop_assert!((r * r.transpose() - Matrix3::identity()).norm() < 1e-12);
            prop_assert!((r.determinant() - 1.0).abs() < 1e-12);
            let least = cost(&found, &points_a, &points_b);
            for sign in [-1.0, 1.0] {
                let mut turned = found;
                turned.rotation = Rotation3::new(sign * 1e-3 * step) * found.rotation;
                turned.translation_m = centroid(&points_a) - turned.rotate(&centroid(&points_b));
                prop_assert!(cost(&turned, &points_a, &points_b) >= least - 1e-9);
                let moved =
                    RigidTransform { translation_m: found.translation_m + sign * 1e-3 * step, ..found };
                prop_assert!(cost(&moved, &points_a, &points_b) >= least - 1e-9);
            }
        }
    }

    #[test]
    fn a_mirror_image_is_not_mistaken_for_a_rotation() {
        let points_b = [
            Vector3::new(3.0, 0.0, 0.0),
            Vector3::new(-3.0, 0.0, 0.0),
            Vector3::new(0.0, 2.0, 0.0),
            Vector3::new(0.0, -2.0, 0.0),
            Vector3::new(0.0, 0.0, 1.0),
            Vector3::new(0.0, 0.0, -1.0),
        ];
        let points_a = points_b.map(|b| Vector3::new(b.x, b.y, -b.z));
        let found = align_rigid(&points_a, &points_b).expect("three extents of their own");
        // An error along the shortest axis costs least.
        assert!((found.matrix() - RigidTransform::IDENTITY.matrix()).norm() < 1e-12);
        // With two equal shortest axes, any rotation about the long one fits as well.
        let points_b = points_b.map(|b| Vector3::new(b.x, b.y, 2.0 * b.z));
        let points_a = points_b.map(|b| Vector3::new(b.x, b.y, -b.z));
        assert_eq!(align_rigid(&points_a, &points_b), None);
    }

    #[test]
    fn what_does_not_fix_a_rotation_gives_none() {
        let triangle = [Vector3::x(), Vector3::y(), Vector3::zeros()];
        let line = [1.0, 2.0, 5.0].map(|s| Vector3::new(0.1 + 0.3 * s, 7.0 - 0.7 * s, 1e3 * s));
        let spot = [Vector3::new(0.1, 0.2, 0.3); 3];
        let broken = [Vector3::x(), Vector3::y(), Vector3::repeat(f64::NAN)];
        let huge = triangle.map(|p| 1e200 * p);
        assert!(align_rigid(&triangle, &triangle).is_some());
        for few in 0..3 {
            assert_eq!(align_rigid(&triangle[..few], &triangle[..few]), None, "{few} points");
        }
        assert_eq!(align_rigid(&triangle, &[triangle, triangle].concat()), None);
        for hopeless in [line, spot, broken, huge] {
            assert_eq!(align_rigid(&hopeless, &hopeless), None, "{hopeless:?}");
            assert_eq!(align_rigid(&hopeless, &triangle), None, "{hopeless:?}");
        }
    }

    #[test]
    fn a_narrow_rig_far_from_the_origin_is_no_less_exact() {
        // A rig 1 m long and 1 mm wide, 1 km away.
        let narrow = [Vector3::zeros(), Vector3::x(), Vector3::new(0.4, 1e-3, 0.0)];
        let truth = RigidTransform {
            rotation: Rotation3::new(Vector3::new(0.3, -1.1, 2.0)),
            translation_m: Vector3::new(800.0, -600.0, 20.0),
        };
        let found = align_rigid(&narrow.map(|b| truth.apply(&b)), &narrow).expect("not a line");
        assert!(found.rotation.angle_to(&truth.rotation) < 1e-8);
    }
}
