//! Recordings for the Rerun viewer: tracks, fates, stations, control points, rates, residuals and the verdict.
//!
//! Entities without a time are static; prisms, rates and distance errors are columns on the timeline `time`.
//! A [`blueprint`] in the recording defines the viewer's layout.
//!
//! # Cost
//! The crate `rerun` with the feature `sdk` brings 267 of the workspace's 634 crates and a third of the build time.
//! Four of its internal crates brought 161 crates and a quarter; their interfaces change with each release.
//!
//! [`rerun::RecordingStream`] is not used: its files of the same data differ ([`chunks`]).
//! [`rerun::sink::GrpcSink`] would stream to a viewer without the program `rerun`, for 1.96 MB in a program of at most 40 MB.

mod blueprint;
mod chunks;

use std::fmt::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use rerun::external::re_log_types::BlueprintActivationCommand;
use rerun::log::LogMsg;
use rerun::{
    EntityPath, LineStrips3D, Points3D, Radius, RecordingInfo, Scalars, SeriesPoints, StoreId,
    StoreKind, TextDocument, TimeColumn, ViewCoordinates,
};
use sha2::{Digest, Sha256};

use self::blueprint::{DISTANCE_ERRORS, RATES, VERDICT};
use self::chunks::Chunks;
use super::rerun_error::RerunError;
use super::text;
use resect_core::analysis::{Analysis, Answer};
use resect_core::deployment::{ControlPoint, Deployment, Track};
use resect_core::geometry::RigidTransform;
use resect_core::network::{Number, Pair, PerStation, Station};
use resect_core::pipeline::SampleFate;
use resect_core::pipeline::outlier_filter::{Rates, rates};
use resect_io::atomic;
use resect_tools::palette;
use resect_tools::palette::Rgb;

/// Version of the SDK, and of the viewer that reads its recordings.
const SDK_VERSION: &str = "0.36.3";

/// Application that the viewer groups recordings and blueprints by.
const APPLICATION: &str = "resect";

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Writes a recording; the same data gives the same bytes.
pub fn save(
    deployment: &Deployment,
    analysis: &Analysis,
    path: &Path,
) -> std::result::Result<(), RerunError> {
    let bytes = messages(deployment, analysis).and_then(|all| Ok(chunks::encode(&all)?));
    Ok(atomic::write(path, bytes.map_err(|error| RerunError::Sdk(error.to_string()))?)?)
}

/// Opens the deployment in the viewer, the program `rerun`, with a temporary file.
///
/// `rerun` streams the file to a viewer that already runs on this machine, and opens a window otherwise.
pub fn open_viewer(
    deployment: &Deployment,
    analysis: &Analysis,
) -> std::result::Result<(), RerunError> {
    let path = std::env::temp_dir().join(format!("resect-{}.rrd", std::process::id()));
    save(deployment, analysis, &path)?;
    let viewer = Command::new("rerun")
        .arg(&path)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    let mut viewer =
        viewer.map_err(|error| RerunError::NoViewer(error.to_string(), SDK_VERSION))?;
    // A child that is never waited for stays in the process table.
    std::thread::spawn(move || viewer.wait());
    Ok(())
}

/// Returns the messages of a recording, its blueprint first.
fn messages(deployment: &Deployment, analysis: &Analysis) -> Result<Vec<LogMsg>> {
    let chunks = log_deployment(deployment, analysis)?;
    let in_store = |recording_id: &str| {
        chunks.messages(&StoreId::new(StoreKind::Recording, APPLICATION, recording_id))
    };
    // The viewer merges recordings with the same id, so the id is a digest of the data.
    let digest = Sha256::digest(chunks::encode(&in_store("")?)?);
    let recording_id = digest[..16].iter().fold(String::new(), |mut id, byte| {
        _ = write!(id, "{byte:02x}");
        id
    });
    let blueprint_id = StoreId::new(StoreKind::Blueprint, APPLICATION, "resect-layout");
    let mut messages = blueprint::blueprint()?.messages(&blueprint_id)?;
    let (make_active, make_default) = (true, true);
    messages.push(BlueprintActivationCommand { blueprint_id, make_active, make_default }.into());
    messages.extend(in_store(&recording_id)?);
    Ok(messages)
}

/// Logs a deployment and its answer.
fn log_deployment(deployment: &Deployment, analysis: &Analysis) -> Result<Chunks> {
    let mut recording = Chunks::default();
    let mut info = RecordingInfo::new().with_name(deployment.name.as_str());
    if let Some(start_s) = deployment.start_s() {
        info = info.with_start_time((start_s * 1e9) as i64);
    }
    recording.log_static(EntityPath::properties(), &info)?;
    let answer = analysis.answer.as_ref().ok();
    let transforms = answer.map_or_else(
        || deployment.tracks.map(|_| RigidTransform::IDENTITY),
        |answer| answer.calibration.station1_from_station.clone(),
    );
    // Entities in another frame would have wrong positions, so they are left out.
    let places_tracks = answer.is_none_or(|a| a.calibration.placing_tracks(deployment).is_some());
    let places_points =
        answer.is_none_or(|a| a.calibration.placing_control_points(deployment).is_some());
    recording.log_static("world", &ViewCoordinates::RIGHT_HAND_Z_UP())?;
    for station in 0..deployment.tracks.len() {
        log_station(
            &mut recording,
            (deployment, analysis),
            station,
            &transforms[station],
            places_tracks,
        )?;
    }
    if places_points {
        log_control_points(&mut recording, deployment, &transforms)?;
    }
    for (station, track) in deployment.tracks.iter().enumerate() {
        log_rates(&mut recording, station, track)?;
    }
    let verdict = match &analysis.answer {
        Ok(answer) => text::calibration(deployment, analysis, answer, ToString::to_string),
        Err(error) => error.to_string(),
    };
    // The columns align only in a monospaced font.
    let verdict = format!("```text\n{verdict}\n```");
    recording.log_static(VERDICT, &TextDocument::from_markdown(verdict))?;
    if let Some(answer) = answer {
        log_distance_errors(&mut recording, answer, &analysis.triplets().time_s)?;
    }
    Ok(recording)
}

/// Logs a station, its readings and its track in the frame of the world.
fn log_station(
    recording: &mut Chunks,
    (deployment, analysis): (&Deployment, &Analysis),
    station: usize,
    transform: &RigidTransform,
    places_tracks: bool,
) -> Result<()> {
    let triplets = analysis.triplets();
    let to_world = |p: nalgebra::Vector3<f64>| {
        let p = transform.apply(&p);
        [p.x as f32, p.y as f32, p.z as f32]
    };
    let root = format!("world/station_{}", station + 1);
    let colour = palette::station(station);
    let here = to_world(nalgebra::Vector3::zeros());
    recording.log_static(
        root.as_str(),
        &points([here], colour, 5.0).with_labels([format!("station {}", station + 1)]),
    )?;
    if !places_tracks {
        return Ok(());
    }
    let track = &deployment.tracks[station];
    for fate in SampleFate::ALL {
        let readings = track.measurements.iter().zip(&analysis.pipeline.fates[station].each);
        let positions: Vec<_> = readings
            .filter(|(_, reading_fate)| **reading_fate == fate)
            .map(|(m, _)| to_world(track.position_m(m)))
            .collect();
        let path = format!("{root}/raw/{}", fate.label().replace([' ', ':'], "_"));
        recording.log_static(path, &points(positions, palette::fate(fate), 1.5))?;
    }
    let strips: Vec<Vec<[f32; 3]>> = (0..triplets.len())
        .collect::<Vec<_>>()
        .chunk_by(|a, b| triplets.interval[*a] == triplets.interval[*b])
        .map(|segment| segment.iter().map(|i| to_world(triplets.points_m[station][*i])).collect())
        .collect();
    recording.log_static(
        format!("{root}/track"),
        &LineStrips3D::new(strips).with_colors([colour]).with_radii([Radius::new_ui_points(1.0)]),
    )?;
    let prism = triplets.points_m[station].iter().map(|p| to_world(*p));
    recording.send_columns(
        format!("{root}/prism"),
        time_column(&triplets.time_s),
        Points3D::new(prism).columns_of_unit_batches()?,
    )?;
    Ok(())
}

/// Logs the readings of the control points, one entity for each file and station.
fn log_control_points(
    recording: &mut Chunks,
    deployment: &Deployment,
    transforms: &PerStation<RigidTransform>,
) -> Result<()> {
    for set in &deployment.control_points {
        for station in 0..transforms.len() {
            let read =
                |p: &ControlPoint| Some((p.marker, (*p.readings.get(Station::at(station))?)?));
            let seen: Vec<_> = set.points.iter().filter_map(read).collect();
            let positions = seen.iter().map(|(_, polar)| {
                let p = transforms[station].apply(&polar.to_cartesian());
                [p.x as f32, p.y as f32, p.z as f32]
            });
            let kind = if set.pillars { blueprint::PILLARS } else { "world/control_points" };
            let path = format!("{kind}/{}/station_{}", set.file.replace('.', "_"), station + 1);
            recording.log_static(
                path,
                &points(positions, palette::station(station), 3.0)
                    .with_labels(seen.iter().map(|(marker, _)| marker.to_string())),
            )?;
        }
    }
    Ok(())
}

/// Logs the errors of the inter-prism distances over time.
fn log_distance_errors(recording: &mut Chunks, answer: &Answer, time_s: &[f64]) -> Result<()> {
    for (pair, errors_mm) in answer.evaluation.distance_errors_mm.each() {
        let Pair { first, second } = pair;
        let name = format!("{first}{second}");
        let path = format!("{DISTANCE_ERRORS}/{name}");
        recording.log_static(
            path.as_str(),
            &SeriesPoints::new().with_colors([palette::pair(pair.index())]).with_names([name]),
        )?;
        recording.send_columns(
            path,
            time_column(time_s),
            Scalars::new(errors_mm.iter().copied()).columns_of_unit_batches()?,
        )?;
    }
    Ok(())
}

/// Logs the rates that the outlier filter tests: of a station, from each reading to the next.
fn log_rates(recording: &mut Chunks, station: usize, track: &Track) -> Result<()> {
    let steps = track.measurements.windows(2);
    let time_s: Vec<f64> = steps.clone().map(|pair| pair[1].time_s).collect();
    let rates: Vec<Rates> = steps.map(|pair| rates(&pair[0], &pair[1])).collect();
    let components: [fn(&Rates) -> f64; 3] =
        [|r| r.range_m_per_s, |r| r.azimuth_deg_per_s, |r| r.zenith_deg_per_s];
    for (rate, component) in RATES.iter().zip(components) {
        let name = format!("station {}", station + 1);
        let path = format!("{}/station_{}", rate.entity, station + 1);
        let series =
            SeriesPoints::new().with_colors([palette::station(station)]).with_names([name]);
        recording.log_static(path.as_str(), &series)?;
        recording.send_columns(
            path,
            time_column(&time_s),
            Scalars::new(rates.iter().map(component)).columns_of_unit_batches()?,
        )?;
    }
    Ok(())
}

/// Points with a radius in screen units: a drive has a hundred metres, and readings are millimetres apart.
fn points(
    positions: impl IntoIterator<Item = [f32; 3]>,
    colour: Rgb,
    radius_points: f32,
) -> Points3D {
    let radius = Radius::new_ui_points(radius_points);
    Points3D::new(positions).with_colors([colour]).with_radii([radius])
}

/// Times on the timeline `time`, in seconds since the epoch.
fn time_column(time_s: &[f64]) -> TimeColumn {
    TimeColumn::new_timestamp_secs_since_epoch("time", time_s.iter().copied())
}
