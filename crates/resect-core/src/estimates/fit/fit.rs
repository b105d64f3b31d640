//! The fit of an estimate: frame, clock, lever arm and the body's rotation.

use nalgebra::{UnitQuaternion, Vector3};

use crate::deployment::Finding;
use crate::estimates::estimate::EstimatedPose;
use crate::estimates::reference::True;
use crate::geometry::RigidTransform;

/// Transform and time offset between an estimate and the ground truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// `station1 = R (scale · estimate) + t`.
    pub station1_from_estimate: RigidTransform,
    pub scale: f64,
    /// Added to the estimate's times (s), with σ if it was estimated.
    pub time_offset_s: f64,
    pub time_offset_sigma_s: Option<f64>,
    /// The body's origin in the vehicle's frame (m), with σ if it was estimated. For a ground truth of a single prism, the
    /// prism in the body's frame. `None` if nothing has an orientation.
    pub lever_arm_m: Option<Vector3<f64>>,
    pub lever_arm_sigma_m: Option<Vector3<f64>>,
    /// `vehicle_from_body`, with σ if it was estimated (rad); `None` if one of the two has no orientation.
    pub body_rotation: Option<UnitQuaternion<f64>>,
    pub body_rotation_sigma_rad: Option<f64>,
    pub findings: Vec<Finding>,
}

impl Fit {
    /// Position of the compared point in station 1's frame, by the estimate and by the ground truth (m).
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

    /// Body's orientation in station 1's frame by the estimate; `None` without orientations.
    pub fn placed_orientation(&self, pose: &EstimatedPose) -> Option<UnitQuaternion<f64>> {
        Some(UnitQuaternion::from(self.station1_from_estimate.rotation) * pose.orientation?)
    }
}
