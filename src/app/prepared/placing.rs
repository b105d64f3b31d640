//! Where the stations and what they measured stand by an answer.

use resect_core::analysis::Analysis;
use resect_core::deployment::Deployment;
use resect_core::geometry::RigidTransform;

/// Where the stations' frames stand in station 1's. Without an answer only station 1, whose frame is the world, has
/// a place.
pub fn placed(analysis: &Analysis) -> [Option<RigidTransform>; 3] {
    match &analysis.answer {
        Ok(answer) => answer.calibration.station1_from_station.map(Some),
        Err(_) => [Some(RigidTransform::IDENTITY), None, None],
    }
}

/// Where the frames of the stations' tracks stand in station 1's; an answer from control points may not place them.
pub fn placed_tracks(deployment: &Deployment, analysis: &Analysis) -> [Option<RigidTransform>; 3] {
    match &analysis.answer {
        Ok(answer) if answer.calibration.placing_tracks(deployment).is_none() => [None; 3],
        _ => placed(analysis),
    }
}
