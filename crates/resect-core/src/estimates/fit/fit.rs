//! The fit of an estimate: frame, clock, lever arm and the body's rotation.

use nalgebra::{UnitQuaternion, Vector3};

use crate::deployment::Finding;
use crate::estimates::estimate::EstimatedPose;
use crate::estimates::reference::True;
use crate::geometry::RigidTransform;

/// How an estimate lies in the ground truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// `station1 = R (scale · estimate) + t`.
    pub station1_from_estimate: RigidTransform,
    pub scale: f64,
    /// What is added to the estimate's times (s); its σ where it was found.
    pub time_offset_s: f64,
    pub time_offset_sigma_s: Option<f64>,
    /// Where the body's origin is in the vehicle's frame (m); of a ground truth of one prism, where the prism is in the
    /// body's frame. `None` where nothing has an orientation. Its σ where it was found.
    pub lever_arm_m: Option<Vector3<f64>>,
    pub lever_arm_sigma_m: Option<Vector3<f64>>,
    /// `vehicle_from_body`, and its σ where it was found (rad); `None` where one of the two has no orientation.
    pub body_rotation: Option<UnitQuaternion<f64>>,
    pub body_rotation_sigma_rad: Option<f64>,
    pub findings: Vec<Finding>,
}

impl Fit {
    /// Where the compared point is in station 1's frame, by the estimate and in truth (m).
    pub fn both_positions_m(&self, pose: &EstimatedPose, truth: &True) -> [Vector3<f64>; 2] {
        let lever_m = self.lever_arm_m.unwrap_or_default();
        let mut placed_m = self.station1_from_estimate.apply(&(self.scale * pose.position_m));
        let mut true_m = truth.position_m;
        match (&truth.turned, self.placed_orientation(pose)) {
            (Some(turned), _) => true_m += turned.orientation * lever_m,
            (None, Some(own)) => placed_m += own * lever_m,
            (None, None) => {}
        }
        [placed_m, true_m]
    }

    /// The body's orientation in station 1's frame, by the estimate.
    pub fn placed_orientation(&self, pose: &EstimatedPose) -> Option<UnitQuaternion<f64>> {
        Some(UnitQuaternion::from(self.station1_from_estimate.rotation) * pose.orientation?)
    }
}
