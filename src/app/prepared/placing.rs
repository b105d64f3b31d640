//! Poses of the stations and of their tracks by a calibration.

use resect_core::analysis::Analysis;
use resect_core::deployment::Deployment;
use resect_core::geometry::RigidTransform;

/// Returns the transforms from the stations' frames to station 1's. Without
/// a calibration only station 1 has one, since its frame is the world.
pub fn placed(analysis: &Analysis) -> [Option<RigidTransform>; 3] {
    match &analysis.answer {
        Ok(answer) => answer.calibration.station1_from_station.map(Some),
        Err(_) => [Some(RigidTransform::IDENTITY), None, None],
    }
}

/// Returns the transforms from the frames of the stations' tracks to station
/// 1's; `None` if a calibration from control points does not determine them.
pub fn placed_tracks(deployment: &Deployment, analysis: &Analysis) -> [Option<RigidTransform>; 3] {
    match &analysis.answer {
        Ok(answer) if answer.calibration.placing_tracks(deployment).is_none() => [None; 3],
        _ => placed(analysis),
    }
}
