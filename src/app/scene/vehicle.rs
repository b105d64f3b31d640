//! The vehicle's poses along its path, and at the cursor.

use resect_core::analysis::Analysis;
use resect_core::deployment::Deployment;
use resect_core::evaluation::trajectory::{Pose, PoseSigma};
use resect_core::evaluation::vehicle::{LARGEST_POSE_ERROR_M, vehicle_at, vehicle_trajectory};
use resect_core::geometry::RigidTransform;
use resect_core::pipeline::Triplets;

/// Greatest number of vehicle frames drawn along the path.
const MOST_POSES: usize = 150;

/// Pose of the vehicle at an instant.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleAt {
    pub time_s: f64,
    pub station1_from_vehicle: RigidTransform,
    pub by: PoseBy,
}

/// Source of a vehicle's pose.
#[derive(Clone, Debug, PartialEq)]
pub enum PoseBy {
    /// The motion of the joint estimate, estimated from the readings around; its σ is computed in the background.
    Motion,
    /// One triplet, by its three distances.
    Triplet(PoseSigma),
}

/// Returns the vehicle's poses at some instants; empty without a rig or a calibration.
fn vehicles(deployment: &Deployment, analysis: &Analysis, some: &Triplets) -> Vec<VehicleAt> {
    let Ok(answer) = &analysis.answer else { return Vec::new() };
    let calibration = &answer.calibration;
    if calibration.joint().is_some() {
        let at = |time_s: &f64| {
            let station1_from_vehicle = vehicle_at(deployment, calibration, *time_s)?;
            Some(VehicleAt { time_s: *time_s, station1_from_vehicle, by: PoseBy::Motion })
        };
        return some.time_s.iter().filter_map(at).collect();
    }
    let (followed, transforms) = (&analysis.offer.followed, calibration.placing_tracks(deployment));
    let found = vehicle_trajectory(deployment, some, followed, transforms, LARGEST_POSE_ERROR_M);
    let at = |pose: &Pose| VehicleAt {
        time_s: pose.time_s,
        station1_from_vehicle: RigidTransform {
            rotation: pose.orientation.to_rotation_matrix(),
            translation_m: pose.position_m,
        },
        by: PoseBy::Triplet(pose.sigma()),
    };
    found.map_or(Vec::new(), |(trajectory, _)| trajectory.poses.iter().map(at).collect())
}

/// Returns the vehicle's poses at even steps along the path.
pub fn poses_along(deployment: &Deployment, analysis: &Analysis) -> Vec<VehicleAt> {
    let count = analysis.triplets().len();
    let instants: Vec<usize> = (0..count).step_by(count.div_ceil(MOST_POSES).max(1)).collect();
    vehicles(deployment, analysis, &analysis.triplets().select(&instants))
}

/// Returns the vehicle's pose at the instant of one triplet; `None` without a rig or a
/// calibration, or if the pose depends on one triplet alone that contradicts the rig.
pub fn pose_of(
    deployment: &Deployment,
    analysis: &Analysis,
    triplet: &Triplets,
) -> Option<VehicleAt> {
    vehicles(deployment, analysis, triplet).pop()
}
