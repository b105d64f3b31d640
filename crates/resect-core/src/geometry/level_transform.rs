//! Rigid transforms between the frames of level instruments: a translation and a yaw.

use nalgebra::{Matrix4, Rotation3, Vector3};
use serde::{Deserialize, Serialize};

use super::wrap_to_pi;

/// A rigid transform that keeps the vertical: four degrees of freedom.
///
/// A value named `a_from_b` maps coordinates in frame b to frame a: `p_a = R(yaw) p_b + t`. Compensators level the stations to
/// about an arcsecond, so the paper gives them no roll and pitch (Vaidis et al. 2022, eq. (2)).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelTransform {
    pub translation_m: Vector3<f64>,
    pub yaw_rad: f64,
}

impl LevelTransform {
    pub const IDENTITY: Self = Self { translation_m: Vector3::new(0.0, 0.0, 0.0), yaw_rad: 0.0 };

    pub fn new(translation_m: Vector3<f64>, yaw_rad: f64) -> Self {
        Self { translation_m, yaw_rad: wrap_to_pi(yaw_rad) }
    }

    /// Maps a point (m).
    pub fn apply(&self, point_m: &Vector3<f64>) -> Vector3<f64> {
        self.rotate(point_m) + self.translation_m
    }

    /// Rotates a direction by the yaw.
    pub fn rotate(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        let (sin, cos) = self.yaw_rad.sin_cos();
        Vector3::new(
            cos * direction.x - sin * direction.y,
            sin * direction.x + cos * direction.y,
            direction.z,
        )
    }

    pub fn inverse(&self) -> Self {
        let back = Self { translation_m: Vector3::zeros(), yaw_rad: -self.yaw_rad };
        Self::new(-back.rotate(&self.translation_m), -self.yaw_rad)
    }

    /// `a_from_b.then_from(b_from_c)` is `a_from_c`.
    pub fn then_from(&self, b_from_c: &Self) -> Self {
        Self::new(self.apply(&b_from_c.translation_m), self.yaw_rad + b_from_c.yaw_rad)
    }

    /// The homogeneous 4×4 matrix.
    pub fn matrix(&self) -> Matrix4<f64> {
        let rotation = Rotation3::from_axis_angle(&Vector3::z_axis(), self.yaw_rad);
        let mut matrix = rotation.to_homogeneous();
        matrix.fixed_view_mut::<3, 1>(0, 3).copy_from(&self.translation_m);
        matrix
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn transform() -> impl Strategy<Value = LevelTransform> {
        (-50.0..50.0f64, -50.0..50.0f64, -5.0..5.0f64, -4.0..4.0f64)
            .prop_map(|(x, y, z, yaw)| LevelTransform::new(Vector3::new(x, y, z), yaw))
    }

    proptest! {
        #[test]
        fn composition_agrees_with_the_matrices(a_from_b in transform(), b_from_c in transform()) {
            let product = a_from_b.matrix() * b_from_c.matrix();
            prop_assert!((a_from_b.then_from(&b_from_c).matrix() - product).norm() < 1e-9);
        }

        #[test]
        fn the_inverse_undoes(a_from_b in transform(), x in -9.0..9.0f64, y in -9.0..9.0f64) {
            let point = Vector3::new(x, y, 1.0);
            prop_assert!((a_from_b.inverse().apply(&a_from_b.apply(&point)) - point).norm() < 1e-10);
        }
    }
}
