//! Stated conventions of an estimate's file, and their effect on its poses.

use nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::left_out_poses::{HeldPart, is_unset, leave_out};
use super::signed_axes::SignedAxes;
use resect_core::deployment::{EstimatedPose, EstimatedTrajectory};

/// Poses that are stated as those of the world in the body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Inverted {
    #[default]
    Nothing,
    /// The orientations alone: positions are those of the body in the world.
    Orientations,
    Poses,
}

/// Angles of roll, pitch and yaw that a file has in another order or sense. The reader composes R = Rz(yaw) Ry(pitch) Rx(roll).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AngleConvention {
    #[default]
    AsRead,
    /// R = Rx(roll) Ry(pitch) Rz(yaw): rotations about the axes of the moving body in the order x, y, z.
    Xyz,
    /// The yaw is a heading: it grows clockwise, while roll and pitch are as usual.
    Clockwise,
}

impl AngleConvention {
    /// Returns the orientation of the angles from which the reader composed another one.
    fn orientation(self, read: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        let (roll, pitch, yaw) = read.euler_angles();
        match self {
            Self::AsRead => read,
            Self::Xyz => {
                let [x, y, z] = [
                    (Vector3::x_axis(), roll),
                    (Vector3::y_axis(), pitch),
                    (Vector3::z_axis(), yaw),
                ]
                .map(|(axis, angle)| UnitQuaternion::from_axis_angle(&axis, angle));
                x * y * z
            }
            Self::Clockwise => UnitQuaternion::from_euler_angles(roll, pitch, -yaw),
        }
    }

    /// Returns the orientation that the reader composes: the inverse of [`Self::orientation`].
    fn as_written(self, orientation: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        match self {
            Self::AsRead => orientation,
            Self::Xyz => {
                // The inverse of Rx Ry Rz is Rz(-yaw) Ry(-pitch) Rx(-roll).
                let (roll, pitch, yaw) = orientation.inverse().euler_angles();
                UnitQuaternion::from_euler_angles(-roll, -pitch, -yaw)
            }
            Self::Clockwise => self.orientation(orientation),
        }
    }
}

/// Conventions of a file that differ from those of this program.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Convention {
    /// The four numbers that were read as x, y, z, w are w, x, y, z.
    pub has_w_first: bool,
    pub angles: AngleConvention,
    /// The axes are left-handed, as in Unreal and Unity: y of the positions is reversed, and orientations turn the other way.
    pub is_left_handed: bool,
    pub inverted: Inverted,
    /// Axes of the positions; they may be left-handed.
    pub position_axes: SignedAxes,
    /// Axes of the world to which the orientations refer, in terms of those of the positions.
    pub world_axes: SignedAxes,
    /// Metres per unit of length.
    pub length_m: f64,
    /// Seconds per unit of time.
    pub time_s: f64,
    /// Leaves out poses that repeat this part of the one before: it was held until the next.
    pub held: Option<HeldPart>,
    /// Leaves out poses at the origin without rotation, which were never set.
    pub has_unset_poses: bool,
}

impl Convention {
    pub const AS_READ: Self = Self {
        has_w_first: false,
        angles: AngleConvention::AsRead,
        is_left_handed: false,
        inverted: Inverted::Nothing,
        position_axes: SignedAxes::AS_READ,
        world_axes: SignedAxes::AS_READ,
        length_m: 1.0,
        time_s: 1.0,
        held: None,
        has_unset_poses: false,
    };

    pub fn is_as_read(&self) -> bool {
        *self == Self::AS_READ
    }

    /// Returns the orientation of the body in the world of the positions.
    pub fn orientation(&self, read: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        let ordered = if self.has_w_first {
            UnitQuaternion::from_quaternion(Quaternion::new(read.i, read.j, read.k, read.w))
        } else {
            read
        };
        let ordered = self.mirrored(self.angles.orientation(ordered));
        let of_body = match self.inverted {
            Inverted::Nothing => ordered,
            Inverted::Orientations | Inverted::Poses => ordered.inverse(),
        };
        let world = Rotation3::from_matrix_unchecked(self.world_axes.matrix());
        UnitQuaternion::from_rotation_matrix(&world) * of_body
    }

    /// Returns the orientation as the file states it: the inverse of [`Self::orientation`].
    pub fn as_written(&self, orientation: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        let world = Rotation3::from_matrix_unchecked(self.world_axes.matrix());
        let of_body = UnitQuaternion::from_rotation_matrix(&world).inverse() * orientation;
        let ordered = match self.inverted {
            Inverted::Nothing => of_body,
            Inverted::Orientations | Inverted::Poses => of_body.inverse(),
        };
        let ordered = self.angles.as_written(self.mirrored(ordered));
        if self.has_w_first {
            UnitQuaternion::from_quaternion(Quaternion::new(
                ordered.k, ordered.w, ordered.i, ordered.j,
            ))
        } else {
            ordered
        }
    }

    /// Returns the orientation with y reversed in world and body, if the axes are left-handed. It is its own inverse.
    fn mirrored(&self, read: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        match self.is_left_handed {
            true => {
                UnitQuaternion::from_quaternion(Quaternion::new(read.w, -read.i, read.j, -read.k))
            }
            false => read,
        }
    }

    /// Returns a pose of the body in the world, in metres and seconds.
    pub fn pose(&self, read: &EstimatedPose) -> EstimatedPose {
        let orientation = read.orientation.map(|read| self.orientation(read));
        let mut position_m = read.position_m;
        if self.is_left_handed {
            position_m.y = -position_m.y;
        }
        let inverse_m = match (self.inverted, read.orientation) {
            (Inverted::Poses, Some(read_orientation)) => {
                let world = Convention { world_axes: SignedAxes::AS_READ, ..*self };
                -(world.orientation(read_orientation) * position_m)
            }
            _ => position_m,
        };
        EstimatedPose {
            time_s: self.time_s * read.time_s,
            position_m: self.length_m * (self.position_axes.matrix() * inverse_m),
            orientation,
        }
    }

    /// Applies the convention to a trajectory. Covariances follow the unit of length; with
    /// other axes or orientations they are dropped.
    pub fn apply(&self, estimate: &mut EstimatedTrajectory) {
        if self.is_as_read() {
            return;
        }
        if self.has_unset_poses {
            leave_out(estimate, |_, pose| is_unset(pose));
        }
        if let Some(part) = self.held {
            leave_out(estimate, |before, pose| {
                before.is_some_and(|before| part.is_repeat(before, pose))
            });
        }
        estimate.poses.iter_mut().for_each(|pose| *pose = self.pose(pose));
        let scaled = Self { length_m: self.length_m, time_s: self.time_s, ..Self::AS_READ };
        let left_out = Self { held: self.held, has_unset_poses: self.has_unset_poses, ..scaled };
        if *self != left_out {
            estimate.covariances.clear();
        }
        for covariance in &mut estimate.covariances {
            covariance.position_m2 *= self.length_m.powi(2);
            covariance.rotation_with_position *= self.length_m;
        }
    }
}

impl Default for Convention {
    fn default() -> Self {
        Self::AS_READ
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;
    use resect_core::deployment::PoseCovariance;

    fn pose(orientation: UnitQuaternion<f64>) -> EstimatedPose {
        EstimatedPose {
            time_s: 2.0,
            position_m: Vector3::new(1.0, 2.0, 3.0),
            orientation: Some(orientation),
        }
    }

    #[test]
    fn each_convention_restores_the_pose_that_was_written_with_it() {
        let turn = UnitQuaternion::from_euler_angles(0.1, -0.4, 2.0);
        let all = Convention::AS_READ;
        let swapped =
            UnitQuaternion::from_quaternion(Quaternion::new(turn.k, turn.w, turn.i, turn.j));
        let clockwise = UnitQuaternion::from_euler_angles(0.1, -0.4, -2.0);
        // The angles about the moving axes x, y, z of the same orientation, composed in the order of the reader.
        let angles = AngleConvention::Xyz;
        let xyz = angles.as_written(turn);
        let (roll, pitch, yaw) = xyz.euler_angles();
        let about = |axis: Vector3<f64>, angle: f64| UnitQuaternion::from_scaled_axis(angle * axis);
        let composed =
            about(Vector3::x(), roll) * about(Vector3::y(), pitch) * about(Vector3::z(), yaw);
        assert!(composed.angle_to(&turn) < 1e-9);
        let ned = SignedAxes::parse("ned").expect("axes");
        let world = UnitQuaternion::from_matrix(&ned.matrix());
        for (convention, written) in [
            (Convention { has_w_first: true, ..all }, swapped),
            (Convention { inverted: Inverted::Orientations, ..all }, turn.inverse()),
            (Convention { angles: AngleConvention::Clockwise, ..all }, clockwise),
            (Convention { angles: AngleConvention::Xyz, ..all }, xyz),
            (Convention { world_axes: ned, ..all }, world.inverse() * turn),
        ] {
            let read = convention.pose(&pose(written));
            assert!(read.orientation.expect("stated").angle_to(&turn) < 1e-9, "{convention:?}");
            assert!(convention.as_written(turn).angle_to(&written) < 1e-9, "{convention:?}");
            assert_eq!(read.position_m, Vector3::new(1.0, 2.0, 3.0));
        }
        let inverse = EstimatedPose {
            position_m: -(turn.inverse() * Vector3::new(1.0, 2.0, 3.0)),
            ..pose(turn.inverse())
        };
        let read = Convention { inverted: Inverted::Poses, ..all }.pose(&inverse);
        assert!((read.position_m - Vector3::new(1.0, 2.0, 3.0)).norm() < 1e-9);
    }

    #[test]
    fn left_handed_poses_are_those_of_a_mirror() {
        // A body at y = -2 that is turned by -2 about z, and by 0.1 about y.
        let turn = UnitQuaternion::from_euler_angles(0.0, 0.1, -2.0);
        let convention = Convention { is_left_handed: true, ..Convention::AS_READ };
        let read = convention.pose(&pose(UnitQuaternion::from_euler_angles(0.0, 0.1, 2.0)));
        assert_eq!(read.position_m, Vector3::new(1.0, -2.0, 3.0));
        assert!(read.orientation.expect("stated").angle_to(&turn) < 1e-9);
    }

    #[test]
    fn units_apply_to_covariances_and_other_axes_drop_them() {
        let estimate = EstimatedTrajectory {
            name: String::new(),
            path: std::path::PathBuf::new(),
            topic: None,
            frames: None,
            poses: vec![pose(UnitQuaternion::identity())],
            covariances: vec![PoseCovariance::of_position(&Vector3::repeat(10.0))],
            origin: None,
            findings: Vec::new(),
        };
        let mut scaled = estimate.clone();
        Convention { length_m: 0.1, time_s: 0.5, ..Convention::AS_READ }.apply(&mut scaled);
        assert_eq!(scaled.poses[0].time_s, 1.0);
        assert!((scaled.poses[0].position_m - Vector3::new(0.1, 0.2, 0.3)).norm() < 1e-12);
        assert!((scaled.covariances[0].position_m2 - Matrix3::identity()).norm() < 1e-9);
        let mut mirrored = estimate;
        let axes = SignedAxes::parse("yxz").expect("axes");
        Convention { position_axes: axes, ..Convention::AS_READ }.apply(&mut mirrored);
        assert_eq!(mirrored.poses[0].position_m, Vector3::new(2.0, 1.0, 3.0));
        assert!(mirrored.covariances.is_empty());
    }
}
