//! Positions that are no metres in one frame: latitudes and longitudes, and motions since the pose before.

use nalgebra::{UnitQuaternion, Vector3};

use super::unit_of_length::compare_shapes;
use crate::estimates::ground_truth::GroundTruth;
use resect_core::deployment::EstimatedPose;
use resect_core::evaluation::no_trajectory::NoTrajectory;

/// Metres per degree of latitude and, at the equator, of longitude. Source: WGS 84; within half a percent everywhere.
const PER_LATITUDE_M: f64 = 111_130.0;
const PER_LONGITUDE_M: f64 = 111_320.0;
/// Largest size of a drive (degrees): 20 km.
const LARGEST_DRIVE_DEGREES: f64 = 0.2;
/// Largest coordinate of a motion since the pose before (m).
const LARGEST_MOTION_M: f64 = 5.0;

/// The meaning of positions that are not what they seem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MisreadPositions {
    /// Names of x and y, which are degrees.
    Degrees([&'static str; 2]),
    /// Each pose is in the frame of the one before.
    Motions,
}

/// Returns the meaning in which the positions have the shape and the size of the ground truth; `None` if they are positions.
pub fn misread_positions(
    truth: &GroundTruth<'_>,
    poses: &[EstimatedPose],
) -> Result<Option<MisreadPositions>, NoTrajectory> {
    let candidates = [
        (in_metres(poses, 0), MisreadPositions::Degrees(["latitude", "longitude"])),
        (in_metres(poses, 1), MisreadPositions::Degrees(["longitude", "latitude"])),
        (in_one_frame(poses), MisreadPositions::Motions),
    ];
    for (converted, meaning) in candidates {
        let Some(converted) = converted else { continue };
        let Some(shapes) = compare_shapes(truth, &converted, None)? else { continue };
        if shapes.is_alike() {
            return Ok(Some(meaning));
        }
    }
    Ok(None)
}

/// Returns the positions in metres east and north of the first; `None` if they cannot be degrees. `latitude` is its coordinate.
fn in_metres(poses: &[EstimatedPose], latitude: usize) -> Option<Vec<EstimatedPose>> {
    let longitude = 1 - latitude;
    let first = poses.first()?.position_m;
    let is_degrees = |pose: &EstimatedPose| {
        let position = pose.position_m;
        position[latitude].abs() <= 90.0
            && position[longitude].abs() <= 180.0
            && (position - first).xy().amax() < LARGEST_DRIVE_DEGREES
    };
    let moves = poses.iter().any(|pose| pose.position_m.xy() != first.xy());
    if !moves || !poses.iter().all(is_degrees) {
        return None;
    }
    let narrowing = first[latitude].to_radians().cos();
    let converted = |pose: &EstimatedPose| {
        let step = pose.position_m - first;
        let position_m = Vector3::new(
            PER_LONGITUDE_M * narrowing * step[longitude],
            PER_LATITUDE_M * step[latitude],
            step.z,
        );
        EstimatedPose { position_m, ..*pose }
    };
    Some(poses.iter().map(converted).collect())
}

/// Returns the motions one after the other; `None` if the positions are too large for motions.
fn in_one_frame(poses: &[EstimatedPose]) -> Option<Vec<EstimatedPose>> {
    let is_motion = |pose: &EstimatedPose| pose.position_m.amax() < LARGEST_MOTION_M;
    if !poses.iter().all(is_motion) {
        return None;
    }
    let (mut position_m, mut orientation) = (Vector3::zeros(), UnitQuaternion::identity());
    let next = |pose: &EstimatedPose| {
        position_m += orientation * pose.position_m;
        // Without orientations, they are along the axes of one frame.
        orientation *= pose.orientation.unwrap_or_else(UnitQuaternion::identity);
        EstimatedPose { position_m, orientation: Some(orientation), ..*pose }
    };
    Some(poses.iter().map(next).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimates::EstimatedTrajectory;
    use std::sync::Arc;

    #[test]
    fn degrees_and_motions_have_the_shape_of_the_drive() {
        let pose = |index: usize| {
            let phase = 0.01 * index as f64;
            let orientation = UnitQuaternion::from_euler_angles(0.0, 0.0, phase);
            EstimatedPose {
                time_s: 0.1 * index as f64,
                position_m: Vector3::new(
                    20.0 * phase.sin() + 3.0 * (0.3 * phase).cos(),
                    8.0 * (2.0 * phase).sin(),
                    0.2 * (3.0 * phase).cos(),
                ),
                orientation: Some(orientation),
            }
        };
        let poses: Vec<EstimatedPose> = (0..1200).map(pose).collect();
        let truth = EstimatedTrajectory {
            name: "truth".to_owned(),
            path: "truth.tum".into(),
            topic: None,
            frames: None,
            poses: poses.clone(),
            covariances: Vec::new(),
            origin: None,
            findings: Vec::new(),
        };
        let truth = GroundTruth::Trajectory(Arc::new(truth), None);
        let meaning = |poses: &[EstimatedPose]| misread_positions(&truth, poses).expect("times");
        assert_eq!(meaning(&poses), None);
        let narrowing = 46.75_f64.to_radians().cos();
        let degrees = |pose: &EstimatedPose| EstimatedPose {
            position_m: Vector3::new(
                46.75 + pose.position_m.y / PER_LATITUDE_M,
                -71.27 + pose.position_m.x / PER_LONGITUDE_M / narrowing,
                pose.position_m.z,
            ),
            ..*pose
        };
        let degrees: Vec<EstimatedPose> = poses.iter().map(degrees).collect();
        assert_eq!(meaning(&degrees), Some(MisreadPositions::Degrees(["latitude", "longitude"])));
        let motion = |two: &[EstimatedPose]| {
            let before = two[0].orientation.expect("turned").inverse();
            EstimatedPose {
                position_m: before * (two[1].position_m - two[0].position_m),
                orientation: Some(before * two[1].orientation.expect("turned")),
                ..two[1]
            }
        };
        let motions: Vec<EstimatedPose> = poses.windows(2).map(motion).collect();
        assert_eq!(meaning(&motions), Some(MisreadPositions::Motions));
    }
}
