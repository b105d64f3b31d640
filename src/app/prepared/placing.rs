//! Poses of the stations and of their tracks by a calibration.

use resect_core::analysis::Analysis;
use resect_core::deployment::Deployment;
use resect_core::geometry::RigidTransform;
use resect_core::network::{Number, PerStation};

/// Returns the transforms from the stations' frames to station 1's. Without a calibration only station 1 has one, since its frame
/// is the world. If a station has no measurement, no calibration is possible, and each of the others is shown in its own frame.
pub fn placed(deployment: &Deployment, analysis: &Analysis) -> PerStation<Option<RigidTransform>> {
    match &analysis.answer {
        Ok(answer) => answer.calibration.station1_from_station.map(|transform| Some(*transform)),
        Err(_) if deployment.ground_truth.is_some() => deployment.tracks.map(|_| None),
        Err(_) => {
            let present = deployment.stations_with_readings();
            let in_own_frame = |station: usize| match present.len() {
                1 | 2 => present.contains(&station),
                _ => station == 0,
            };
            deployment.tracks.map_each(|station, _| {
                in_own_frame(station.index()).then_some(RigidTransform::IDENTITY)
            })
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
pub fn placed_tracks(
    deployment: &Deployment,
    analysis: &Analysis,
) -> PerStation<Option<RigidTransform>> {
    match &analysis.answer {
        Ok(answer) if answer.calibration.placing_tracks(deployment).is_none() => {
            deployment.tracks.map(|_| None)
        }
        _ => placed(deployment, analysis),
    }
}
