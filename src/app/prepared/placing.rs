//! Poses of the stations and of their tracks by a calibration.

use resect_core::analysis::Analysis;
use resect_core::deployment::Deployment;
use resect_core::geometry::RigidTransform;

/// Returns the transforms from the stations' frames to station 1's. Without a calibration only station 1 has one, since its frame
/// is the world. If a station has no measurement, no calibration is possible, and each of the others is shown in its own frame.
pub fn placed(deployment: &Deployment, analysis: &Analysis) -> [Option<RigidTransform>; 3] {
    match &analysis.answer {
        Ok(answer) => {
            let transforms = answer.calibration.station1_from_station.as_slice();
            [0, 1, 2].map(|station: usize| transforms.get(station).copied())
        }
        Err(_) if deployment.ground_truth.is_some() => [None; 3],
        Err(_) => {
            let present = deployment.stations_with_readings();
            let in_own_frame = |station: usize| match present.len() {
                1 | 2 => present.contains(&station),
                _ => station == 0,
            };
            [0, 1, 2].map(|station| in_own_frame(station).then_some(RigidTransform::IDENTITY))
        }
    }
}

/// Names the frame of the scene.
pub fn frame_in_words(deployment: &Deployment, analysis: &Analysis) -> String {
    if let Some(truth) = &deployment.ground_truth {
        return format!("frame of {}, from its first position", truth.name);
    }
    match (&analysis.answer, &deployment.stations_with_readings()[..]) {
        (Err(_), [only]) => format!("frame of station {}, z up", only + 1),
        (Err(_), [_, _]) => "each station in its own frame: not calibrated".to_owned(),
        _ => "frame of station 1, z up".to_owned(),
    }
}

/// Returns the transforms from the frames of the stations' tracks to station
/// 1's; `None` if a calibration from control points does not determine them.
pub fn placed_tracks(deployment: &Deployment, analysis: &Analysis) -> [Option<RigidTransform>; 3] {
    match &analysis.answer {
        Ok(answer) if answer.calibration.placing_tracks(deployment).is_none() => [None; 3],
        _ => placed(deployment, analysis),
    }
}
