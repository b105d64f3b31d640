//! Positions of the ground truth, computed once for many comparisons.

use std::path::PathBuf;
use std::sync::Arc;

use crate::estimates::ground_truth::GroundTruth;
use resect_core::deployment::{EstimatedPose, EstimatedTrajectory};
use resect_core::evaluation::no_trajectory::NoTrajectory;
use resect_core::evaluation::vehicle::Instants;

/// Rate of the positions of a deployment (Hz): that of the comparison of speeds.
const RATE_HZ: f64 = 10.0;

/// Returns the ground truth as a trajectory, that of a deployment as positions; `None` if it has no times.
pub fn position_truth(
    truth: &GroundTruth<'_>,
) -> Result<Option<Arc<EstimatedTrajectory>>, NoTrajectory> {
    if let GroundTruth::Trajectory(truth, _) = truth {
        return Ok((!truth.poses.is_empty()).then(|| Arc::clone(truth)));
    }
    let poses: Vec<EstimatedPose> = truth
        .at(Instants::Rate(RATE_HZ))?
        .iter()
        .map(|truth| EstimatedPose {
            time_s: truth.time_s,
            position_m: truth.position_m,
            orientation: None,
        })
        .collect();
    let trajectory = EstimatedTrajectory {
        name: truth.name().to_owned(),
        path: PathBuf::new(),
        topic: None,
        frames: None,
        poses,
        covariances: Vec::new(),
        origin: None,
        findings: Vec::new(),
    };
    Ok((!trajectory.poses.is_empty()).then(|| Arc::new(trajectory)))
}
