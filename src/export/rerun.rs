//! Recordings for the Rerun viewer: tracks, fates, stations, control points and residuals.
//!
//! Everything that stands still is static; prisms and distance errors are columns on the timeline `time`.

use std::path::Path;

use rerun::{
    LineStrips3D, Points3D, RecordingStream, RecordingStreamBuilder, Scalars, SeriesPoints,
    TimeColumn,
};

use crate::analysis::Analysis;
use crate::deployment::{Deployment, PAIRS};
use crate::geometry::RigidTransform;
use crate::palette::{self, Rgb};
use crate::pipeline::SampleFate;

#[derive(Debug, thiserror::Error)]
pub enum RerunError {
    #[error("{path}: the recording could not be written: {what}")]
    Write { path: String, what: String },
    #[error("the Rerun viewer did not start: {0}; install it with `pip install rerun-sdk=={1}`")]
    NoViewer(String, &'static str),
}

/// Version of the SDK, and so of the viewer that surely reads its recordings.
const SDK_VERSION: &str = "0.36.3";

/// Writes a recording.
pub fn save(deployment: &Deployment, analysis: &Analysis, path: &Path) -> Result<(), RerunError> {
    let write = |what: &dyn std::fmt::Display| RerunError::Write {
        path: path.display().to_string(),
        what: what.to_string(),
    };
    // The SDK makes the file lazily and only logs a failure; find out first.
    std::fs::File::create(path).map_err(|error| write(&error))?;
    let recording =
        RecordingStreamBuilder::new("resect").save(path).map_err(|error| write(&error))?;
    log_all(&recording, deployment, analysis).map_err(|error| write(&error))?;
    recording.flush_blocking().map_err(|error| write(&error))
}

/// Starts the viewer (or uses a running one) and shows the deployment in it.
pub fn open_viewer(deployment: &Deployment, analysis: &Analysis) -> Result<(), RerunError> {
    let failed = |error: &dyn std::fmt::Display| {
        let first =
            error.to_string().lines().next().unwrap_or_default().trim_end_matches('.').to_owned();
        RerunError::NoViewer(first, SDK_VERSION)
    };
    let recording =
        RecordingStreamBuilder::new("resect").spawn().map_err(|error| failed(&error))?;
    log_all(&recording, deployment, analysis).map_err(|error| failed(&error))?;
    recording.flush_blocking().map_err(|error| failed(&error))
}

fn log_all(
    recording: &RecordingStream,
    deployment: &Deployment,
    analysis: &Analysis,
) -> Result<(), Box<dyn std::error::Error>> {
    let answer = analysis.answer.as_ref().ok();
    let transforms =
        answer.map_or([RigidTransform::IDENTITY; 3], |a| a.calibration.station1_from_station);
    let triplets = analysis.triplets();
    recording.log_static("world", &rerun::ViewCoordinates::RIGHT_HAND_Z_UP())?;
    for station in 0..3 {
        let to_world = |p: nalgebra::Vector3<f64>| {
            let p = transforms[station].apply(&p);
            [p.x as f32, p.y as f32, p.z as f32]
        };
        let root = format!("world/station_{}", station + 1);
        let colour = palette::STATIONS[station];
        let here = to_world(nalgebra::Vector3::zeros());
        recording.log_static(
            root.as_str(),
            &points([here], colour, 0.15).with_labels([format!("station {}", station + 1)]),
        )?;
        let track = &deployment.tracks[station];
        for fate in SampleFate::ALL {
            let readings = track.measurements.iter().zip(&analysis.pipeline.fates[station].each);
            let positions: Vec<_> = readings
                .filter(|(_, own)| **own == fate)
                .map(|(m, _)| to_world(track.position_m(m)))
                .collect();
            let path = format!("{root}/raw/{}", fate.label().replace([' ', ':'], "_"));
            recording.log_static(path, &points(positions, palette::fate(fate), 0.03))?;
        }
        let strips: Vec<Vec<[f32; 3]>> = (0..triplets.len())
            .collect::<Vec<_>>()
            .chunk_by(|a, b| triplets.interval[*a] == triplets.interval[*b])
            .map(|part| part.iter().map(|i| to_world(triplets.points_m[station][*i])).collect())
            .collect();
        recording.log_static(
            format!("{root}/track"),
            &LineStrips3D::new(strips).with_colors([colour]).with_radii([0.015]),
        )?;
        let prism = triplets.points_m[station].iter().map(|p| to_world(*p));
        recording.send_columns(
            format!("{root}/prism"),
            [time_column(&triplets.time_s)],
            Points3D::new(prism).columns_of_unit_batches()?,
        )?;
    }
    for set in &deployment.control_points {
        for station in 0..3 {
            let seen: Vec<_> =
                set.points.iter().filter_map(|p| Some((p.marker, p.readings[station]?))).collect();
            let positions = seen.iter().map(|(_, polar)| {
                let p = transforms[station].apply(&polar.to_cartesian());
                [p.x as f32, p.y as f32, p.z as f32]
            });
            let path = format!(
                "world/control_points/{}/station_{}",
                set.file.replace('.', "_"),
                station + 1
            );
            recording.log_static(
                path,
                &points(positions, palette::STATIONS[station], 0.08)
                    .with_labels(seen.iter().map(|(marker, _)| marker.to_string())),
            )?;
        }
    }
    if let Some(answer) = answer {
        for (pair, (a, b)) in PAIRS.into_iter().enumerate() {
            let name = format!("{}{}", a + 1, b + 1);
            let path = format!("distance_error_mm/{name}");
            recording.log_static(
                path.as_str(),
                &SeriesPoints::new().with_colors([palette::PAIRS[pair]]).with_names([name]),
            )?;
            recording.send_columns(
                path,
                [time_column(&triplets.time_s)],
                Scalars::new(answer.evaluation.distance_errors_mm[pair].iter().copied())
                    .columns_of_unit_batches()?,
            )?;
        }
    }
    Ok(())
}

fn points(positions: impl IntoIterator<Item = [f32; 3]>, colour: Rgb, radius_m: f32) -> Points3D {
    Points3D::new(positions).with_colors([colour]).with_radii([radius_m])
}

fn time_column(time_s: &[f64]) -> TimeColumn {
    TimeColumn::new_timestamp_secs_since_epoch("time", time_s.iter().copied())
}
