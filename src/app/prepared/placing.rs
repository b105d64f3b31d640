//! Where the stations and what they measured stand by an answer.

use crate::analysis::Analysis;
use crate::deployment::Deployment;
use crate::geometry::RigidTransform;

/// Where the stations' frames stand in station 1's. Without an answer only station 1, whose frame is the world, has
/// a place.
pub fn placed(analysis: &Analysis) -> [Option<RigidTransform>; 3] {
    match &analysis.answer {
        Ok(answer) => answer.calibration.station1_from_station.map(Some),
        Err(_) => [Some(RigidTransform::IDENTITY), None, None],
    }
}

/// The same for their tracks, which an answer from control points may not place.
pub fn placed_tracks(deployment: &Deployment, analysis: &Analysis) -> [Option<RigidTransform>; 3] {
    match &analysis.answer {
        Ok(answer) if answer.calibration.placing_tracks(deployment).is_none() => [None; 3],
        _ => placed(analysis),
    }
}
