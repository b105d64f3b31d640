//! Rigid transforms: a translation and any rotation.

use nalgebra::{Matrix3, Matrix4, Rotation3, Vector3};

use super::LevelTransform;

/// A rigid transform: six degrees of freedom.
///
/// A value named `a_from_b` maps coordinates in frame b to frame a: `p_a = R p_b + t`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidTransform {
    pub rotation: Rotation3<f64>,
    pub translation_m: Vector3<f64>,
}

impl RigidTransform {
    pub const IDENTITY: Self = Self {
        rotation: Rotation3::from_matrix_unchecked(Matrix3::new(
            1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0,
        )),
        translation_m: Vector3::new(0.0, 0.0, 0.0),
    };

    /// Maps a point (m).
    pub fn apply(&self, point_m: &Vector3<f64>) -> Vector3<f64> {
        self.rotate(point_m) + self.translation_m
    }

    /// Rotates a direction.
    pub fn rotate(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * direction
    }

    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        Self { rotation, translation_m: -(rotation * self.translation_m) }
    }

    /// `a_from_b.then_from(b_from_c)` is `a_from_c`.
    pub fn then_from(&self, b_from_c: &Self) -> Self {
        Self {
            rotation: self.rotation * b_from_c.rotation,
            translation_m: self.apply(&b_from_c.translation_m),
        }
    }

    /// The homogeneous 4×4 matrix.
    pub fn matrix(&self) -> Matrix4<f64> {
        let mut matrix = self.rotation.to_homogeneous();
        matrix.fixed_view_mut::<3, 1>(0, 3).copy_from(&self.translation_m);
        matrix
    }

    /// Rotation about z, the last of roll, pitch and yaw; in [−π, π].
    pub fn yaw_rad(&self) -> f64 {
        let r = self.rotation.matrix();
        r[(1, 0)].atan2(r[(0, 0)])
    }

    /// Angle between the vertical axes of the two frames; in [0, π].
    pub fn tilt_rad(&self) -> f64 {
        let r = self.rotation.matrix();
        // Not acos(r22), which cannot resolve angles below about 1e-8 rad.
        r[(0, 2)].hypot(r[(1, 2)]).atan2(r[(2, 2)])
    }
}

impl From<&LevelTransform> for RigidTransform {
    fn from(level: &LevelTransform) -> Self {
        Self::from(*level)
    }
}

impl From<LevelTransform> for RigidTransform {
    fn from(level: LevelTransform) -> Self {
        Self {
            rotation: Rotation3::from_axis_angle(&Vector3::z_axis(), level.yaw_rad),
            translation_m: level.translation_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn transform() -> impl Strategy<Value = RigidTransform> {
        (proptest::array::uniform3(-50.0..50.0f64), (-3.0..3.0f64, -1.5..1.5f64, -3.0..3.0f64))
            .prop_map(|(translation_m, (roll, pitch, yaw))| RigidTransform {
                rotation: Rotation3::from_euler_angles(roll, pitch, yaw),
                translation_m: translation_m.into(),
            })
    }

    #[test]
    fn tilt_is_good_near_zero() {
        for tilt_rad in [0.0, 1e-12, 1e-9, 0.3, 3.1] {
            let rotation = Rotation3::from_euler_angles(0.0, 0.0, 0.7)
                * Rotation3::from_euler_angles(tilt_rad, 0.0, 0.0);
            let tilted = RigidTransform { rotation, translation_m: Vector3::zeros() };
            assert!((tilted.tilt_rad() - tilt_rad).abs() < 1e-14 + 1e-12 * tilt_rad);
        }
    }

    proptest! {
        #[test]
        fn composition_agrees_with_the_matrices(a_from_b in transform(), b_from_c in transform()) {
            let product = a_from_b.matrix() * b_from_c.matrix();
            prop_assert!((a_from_b.then_from(&b_from_c).matrix() - product).norm() < 1e-9);
        }

        #[test]
        fn the_inverse_undoes(a_from_b in transform(), point in proptest::array::uniform3(-9.0..9.0f64)) {
            let point = Vector3::from(point);
            prop_assert!((a_from_b.inverse().apply(&a_from_b.apply(&point)) - point).norm() < 1e-10);
            prop_assert_eq!(a_from_b.then_from(&RigidTransform::IDENTITY), a_from_b);
        }

        #[test]
        fn yaw_is_the_euler_angle(roll in -1.5..1.5f64, pitch in -1.5..1.5f64, yaw in -3.0..3.0f64) {
            let rotation = Rotation3::from_euler_angles(roll, pitch, yaw);
            let turned = RigidTransform { rotation, translation_m: Vector3::zeros() };
            prop_assert!((turned.yaw_rad() - yaw).abs() < 1e-12);
        }

        #[test]
        fn a_level_transform_is_a_rigid_one(x in -9.0..9.0f64, yaw in -3.0..3.0f64) {
            let level = LevelTransform::new(Vector3::new(x, 2.0, -1.0), yaw);
            let rigid = RigidTransform::from(level);
            prop_assert!((rigid.matrix() - level.matrix()).norm() < 1e-12);
            prop_assert!((rigid.yaw_rad() - yaw).abs() < 1e-12 && rigid.tilt_rad() == 0.0);
        }
    }
}
