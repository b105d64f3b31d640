//! Projection of positions and orientations to a plane of the ground truth's frame, as evo defines it.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// Plane of the ground truth's frame to which both trajectories are projected after the alignment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Plane {
    Xy,
    Xz,
    Yz,
}

impl Plane {
    /// Name of the plane: "xy".
    pub fn name(self) -> &'static str {
        match self {
            Self::Xy => "xy",
            Self::Xz => "xz",
            Self::Yz => "yz",
        }
    }

    /// Index of the axis perpendicular to the plane.
    fn normal(self) -> usize {
        match self {
            Self::Xy => 2,
            Self::Xz => 1,
            Self::Yz => 0,
        }
    }

    pub fn project(self, mut position_m: Vector3<f64>) -> Vector3<f64> {
        position_m[self.normal()] = 0.0;
        position_m
    }

    /// Returns the rotation about the plane's normal by the roll, pitch or yaw of an orientation about that axis.
    pub fn project_orientation(self, orientation: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        let rotation = orientation.to_rotation_matrix();
        let cosine = rotation[(0, 0)].hypot(rotation[(1, 0)]);
        let is_regular = cosine > 1e-12;
        let angle_rad = match self {
            Self::Xy if is_regular => rotation[(1, 0)].atan2(rotation[(0, 0)]),
            Self::Xy => 0.0,
            Self::Xz => (-rotation[(2, 0)]).atan2(cosine),
            Self::Yz if is_regular => rotation[(2, 1)].atan2(rotation[(2, 2)]),
            Self::Yz => (-rotation[(1, 2)]).atan2(rotation[(1, 1)]),
        };
        UnitQuaternion::from_scaled_axis(Vector3::ith(self.normal(), angle_rad))
    }

    /// Returns the covariance of a projected position.
    pub fn project_covariance(self, mut covariance: Matrix3<f64>) -> Matrix3<f64> {
        covariance.row_mut(self.normal()).fill(0.0);
        covariance.column_mut(self.normal()).fill(0.0);
        covariance
    }

    /// Returns the covariance of a rotation about the plane's normal.
    pub fn project_rotation_covariance(self, covariance: &Matrix3<f64>) -> Matrix3<f64> {
        let normal = self.normal();
        let mut projected = Matrix3::zeros();
        projected[(normal, normal)] = covariance[(normal, normal)];
        projected
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_orientation_keeps_the_angle_about_the_normal() {
        let turn = UnitQuaternion::from_euler_angles(0.2, -0.4, 1.1);
        for (plane, axis, angle_rad) in
            [(Plane::Xy, 2, 1.1), (Plane::Xz, 1, -0.4), (Plane::Yz, 0, 0.2)]
        {
            let expected = UnitQuaternion::from_scaled_axis(Vector3::ith(axis, angle_rad));
            assert!(plane.project_orientation(&turn).angle_to(&expected) < 1e-12, "{plane:?}");
            assert_eq!(plane.project(Vector3::repeat(2.0))[axis], 0.0);
        }
    }
}
