//! The fit of an estimate: frame, clock, lever arm and the body's rotation.

use nalgebra::{Matrix3, SMatrix, UnitQuaternion, Vector3};

use super::clock_change::ClockChange;
use super::unknowns::{BODY, SCALE};
use crate::estimates::matched_pose::TruePose;
use crate::estimates::plane::Plane;
use resect_core::calibration::Estimate;
use resect_core::deployment::EstimatedPose;
use resect_core::deployment::Finding;
use resect_core::geometry::RigidTransform;

/// Prior standard deviation of a lever arm (m), of the size of a vehicle. It decides only where the drive does not determine
/// the lever arm, such as its height on level ground.
pub const LEVER_SIGMA_M: f64 = 1.0;
/// A time offset or a component of the lever arm is determined if its σ is below this share of the prior's.
pub const LEAST_GAIN: f64 = 0.5;

/// Covariance of lever arm (m), time offset (s) and the body's rotation about the vehicle's axes (rad).
pub type FitCovariance = SMatrix<f64, SCALE, SCALE>;

/// Transform and time offset between an estimate and the ground truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// `truth = R (scale · estimate) + t`. The ground truth of a deployment is in station 1's frame.
    pub truth_from_estimate: RigidTransform,
    pub scale: f64,
    /// Added to the estimate's times (s), with σ if it was estimated.
    pub time_offset_s: f64,
    pub time_offset_sigma_s: Option<f64>,
    /// False if only the prior of the time offset decides: the estimate stands still at the surveyed points.
    pub determines_time_offset: bool,
    /// Change of the time offset during the drive, if it was estimated and is not constant.
    pub clock_change: Option<ClockChange>,
    /// The body's origin in the vehicle's frame (m), with σ if it was estimated. For a ground truth of a single prism, the
    /// prism in the body's frame. `None` if nothing has an orientation.
    pub lever_arm_m: Option<Vector3<f64>>,
    pub lever_arm_sigma_m: Option<Vector3<f64>>,
    /// Covariance of what was estimated; zero elsewhere.
    pub covariance: FitCovariance,
    /// `vehicle_from_body`, with σ about the vehicle's axes if it was estimated (rad); `None` if one of the two has no orientation.
    pub body_rotation: Option<UnitQuaternion<f64>>,
    pub body_rotation_sigma_rad: Option<Vector3<f64>>,
    /// Factor of the estimate's lengths beside the lever arm, if it was estimated. It has a prior unless the alignment has a scale.
    pub estimated_scale: Option<Estimate>,
    /// Plane to which both trajectories are projected.
    pub plane: Option<Plane>,
    pub findings: Vec<Finding>,
}

impl Fit {
    /// Returns true if the drive determines a component of the lever arm better than its prior does.
    pub fn determines_lever_arm(&self, axis: usize) -> bool {
        self.lever_arm_sigma_m.is_none_or(|sigma_m| sigma_m[axis] < LEAST_GAIN * LEVER_SIGMA_M)
    }

    /// Covariance of the lever arm (m²) if it was estimated.
    pub fn lever_arm_covariance_m2(&self) -> Option<Matrix3<f64>> {
        self.lever_arm_sigma_m.map(|_| self.covariance.fixed_view::<3, 3>(0, 0).into_owned())
    }

    /// Roll, pitch and yaw of `vehicle_from_body` (rad), with σ 0 if they were not estimated; `None` without orientations.
    pub fn body_angles_rad(&self) -> Option<[Estimate; 3]> {
        const STEP_RAD: f64 = 1e-6;
        let body = self.body_rotation?;
        let angles = |turn: Vector3<f64>| {
            let (roll, pitch, yaw) = (UnitQuaternion::from_scaled_axis(turn) * body).euler_angles();
            Vector3::new(roll, pitch, yaw)
        };
        let angles_rad = angles(Vector3::zeros());
        let steps = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| axis * STEP_RAD);
        let columns = steps.map(|step| {
            let difference = angles(step) - angles_rad;
            difference.map(|angle| angle.sin().atan2(angle.cos()) / STEP_RAD)
        });
        let by_turn = Matrix3::from_columns(&columns);
        let of_body = self.covariance.fixed_view::<3, 3>(BODY, BODY);
        let covariance = by_turn * of_body * by_turn.transpose();
        Some(std::array::from_fn(|axis| Estimate {
            value: angles_rad[axis],
            sigma: covariance[(axis, axis)].max(0.0).sqrt(),
        }))
    }

    /// Position of the compared point in the ground truth's frame, by the estimate and by the ground truth (m).
    pub fn both_positions_m(&self, pose: &EstimatedPose, truth: &TruePose) -> [Vector3<f64>; 2] {
        let lever_m = self.lever_arm_m.unwrap_or_default();
        let mut placed_m = self.truth_from_estimate.apply(&(self.scale * pose.position_m));
        let mut true_m = truth.position_m;
        match (&truth.rotation, self.placed_orientation(pose)) {
            (Some(rotation), _) => true_m += rotation.orientation * lever_m,
            (None, Some(own)) => placed_m += own * lever_m,
            (None, None) => {}
        }
        let project = |position_m| self.plane.map_or(position_m, |plane| plane.project(position_m));
        [placed_m, true_m].map(project)
    }

    /// Orientations of the body in the ground truth's frame, by the estimate and by the ground truth; `None` without orientations.
    pub fn both_orientations(
        &self,
        pose: &EstimatedPose,
        truth: &TruePose,
    ) -> Option<[UnitQuaternion<f64>; 2]> {
        let true_orientation = truth.rotation.as_ref()?.orientation * self.body_rotation?;
        let both = [self.placed_orientation(pose)?, true_orientation];
        Some(match self.plane {
            Some(plane) => both.map(|orientation| plane.project_orientation(&orientation)),
            None => both,
        })
    }

    /// Position of the compared point in the ground truth's frame at a pose without ground truth (m).
    pub fn placed_position_m(&self, pose: &EstimatedPose) -> Vector3<f64> {
        let placed_m = self.truth_from_estimate.apply(&(self.scale * pose.position_m));
        // With both orientations the compared point is the body's origin.
        match self.placed_orientation(pose).filter(|_| self.body_rotation.is_none()) {
            Some(own) => placed_m + own * self.lever_arm_m.unwrap_or_default(),
            None => placed_m,
        }
    }

    /// Body's orientation in the ground truth's frame by the estimate; `None` without orientations.
    pub fn placed_orientation(&self, pose: &EstimatedPose) -> Option<UnitQuaternion<f64>> {
        Some(UnitQuaternion::from(self.truth_from_estimate.rotation) * pose.orientation?)
    }
}
