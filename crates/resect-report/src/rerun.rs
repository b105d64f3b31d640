//! Recordings for the Rerun viewer: tracks, fates, stations, control points, rates, residuals and the verdict.
//!
//! Everything that stands still is static; prisms, rates and distance errors are columns on the timeline `time`.
//! A [`blueprint`] in the recording says how the viewer lays them out.

mod blueprint;
mod chunks;

use std::fmt::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use re_chunk::TimeColumn;
use re_log_types::{BlueprintActivationCommand, EntityPath, LogMsg, StoreId, StoreKind};
use re_sdk_types::archetypes::{
    LineStrips3D, Points3D, RecordingInfo, Scalars, SeriesPoints, TextDocument, ViewCoordinates,
};
use re_sdk_types::components::Radius;
use sha2::{Digest, Sha256};

use self::blueprint::{DISTANCE_ERRORS, RATES, VERDICT};
use self::chunks::Chunks;
use super::text;
use resect_core::analysis::{Analysis, Answer};
use resect_core::deployment::{Deployment, PAIRS, Track};
use resect_core::geometry::RigidTransform;
use resect_core::palette;
use resect_core::palette::Rgb;
use resect_core::pipeline::SampleFate;
use resect_core::pipeline::outlier_filter::{Rates, rates};
use resect_io::atomic;
use resect_io::atomic::WriteError;

#[derive(Debug, thiserror::Error)]
pub enum RerunError {
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("the Rerun SDK made no recording: {0}; report it, with the data")]
    Sdk(String),
    #[error("the Rerun viewer did not start: {0}; install it with `pip install rerun-sdk=={1}`")]
    NoViewer(String, &'static str),
}

/// Version of the SDK, and so of the viewer that surely reads its recordings.
const SDK_VERSION: &str = "0.36.3";

/// By which the viewer tells whose recordings and layouts belong together.
const APPLICATION: &str = "resect";

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Writes a recording; the same data gives the same bytes.
pub fn save(
    deployment: &Deployment,
    analysis: &Analysis,
    path: &Path,
) -> std::result::Result<(), RerunError> {
    let bytes = recording(deployment, analysis);
    Ok(atomic::write(path, bytes.map_err(|error| RerunError::Sdk(error.to_string()))?)?)
}

/// Starts the viewer (or uses a running one) and shows the deployment in it.
///
/// The viewer is a program of its own, `rerun`, which opens recordings.
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
    // Who waits for nobody leaves the ended viewer in the system's table.
    std::thread::spawn(move || viewer.wait());
    Ok(())
}

/// The bytes of a recording, its layout first.
fn recording(deployment: &Deployment, analysis: &Analysis) -> Result<Vec<u8>> {
    let chunks = log_all(deployment, analysis)?;
    let (layout, activation) = layout()?;
    let messages = |recording_id: &str| {
        chunks.messages(&StoreId::new(StoreKind::Recording, APPLICATION, recording_id))
    };
    // Two recordings that the viewer has open may share nothing but what is the same in both.
    let digest = Sha256::digest(chunks::bytes(&messages("")?)?);
    let recording_id = digest[..16].iter().fold(String::new(), |mut id, byte| {
        _ = write!(id, "{byte:02x}");
        id
    });
    let activation = [LogMsg::BlueprintActivationCommand(activation)];
    Ok(chunks::bytes(layout.iter().chain(&activation).chain(&messages(&recording_id)?))?)
}

/// The layout, and what says that it is there to be used.
fn layout() -> Result<(Vec<LogMsg>, BlueprintActivationCommand)> {
    let blueprint_id = StoreId::new(StoreKind::Blueprint, APPLICATION, "resect-layout");
    let messages = blueprint::blueprint()?.messages(&blueprint_id)?;
    let (make_active, make_default) = (true, true);
    Ok((messages, BlueprintActivationCommand { blueprint_id, make_active, make_default }))
}

/// Everything about a deployment and its answer.
fn log_all(deployment: &Deployment, analysis: &Analysis) -> Result<Chunks> {
    let mut recording = Chunks::default();
    let mut info = RecordingInfo::new().with_name(deployment.name.as_str());
    if let Some(start_s) = deployment.start_s() {
        info = info.with_start_time((start_s * 1e9) as i64);
    }
    recording.log_static(EntityPath::properties(), &info)?;
    let answer = analysis.answer.as_ref().ok();
    let transforms =
        answer.map_or([RigidTransform::IDENTITY; 3], |a| a.calibration.station1_from_station);
    // What another frame holds is left out: it would stand in the wrong place.
    let places_tracks = answer.is_none_or(|a| a.calibration.placing_tracks(deployment).is_some());
    let places_points =
        answer.is_none_or(|a| a.calibration.placing_control_points(deployment).is_some());
    recording.log_static("world", &ViewCoordinates::RIGHT_HAND_Z_UP())?;
    for station in 0..3 {
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
    // Its columns stand one below the other only in letters of one width.
    let verdict = format!("```text\n{verdict}\n```");
    recording.log_static(VERDICT, &TextDocument::from_markdown(verdict))?;
    if let Some(answer) = answer {
        log_distance_errors(&mut recording, answer, &analysis.triplets().time_s)?;
    }
    Ok(recording)
}

/// A station, its readings and its track, moved into the world.
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
    let colour = palette::STATIONS[station];
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
            .filter(|(_, own)| **own == fate)
            .map(|(m, _)| to_world(track.position_m(m)))
            .collect();
        let path = format!("{root}/raw/{}", fate.label().replace([' ', ':'], "_"));
        recording.log_static(path, &points(positions, palette::fate(fate), 1.5))?;
    }
    let strips: Vec<Vec<[f32; 3]>> = (0..triplets.len())
        .collect::<Vec<_>>()
        .chunk_by(|a, b| triplets.interval[*a] == triplets.interval[*b])
        .map(|part| part.iter().map(|i| to_world(triplets.points_m[station][*i])).collect())
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

fn log_control_points(
    recording: &mut Chunks,
    deployment: &Deployment,
    transforms: &[RigidTransform; 3],
) -> Result<()> {
    for set in &deployment.control_points {
        for station in 0..3 {
            let seen: Vec<_> =
                set.points.iter().filter_map(|p| Some((p.marker, p.readings[station]?))).collect();
            let positions = seen.iter().map(|(_, polar)| {
                let p = transforms[station].apply(&polar.to_cartesian());
                [p.x as f32, p.y as f32, p.z as f32]
            });
            let kind = if set.pillars { blueprint::PILLARS } else { "world/control_points" };
            let path = format!("{kind}/{}/station_{}", set.file.replace('.', "_"), station + 1);
            recording.log_static(
                path,
                &points(positions, palette::STATIONS[station], 3.0)
                    .with_labels(seen.iter().map(|(marker, _)| marker.to_string())),
            )?;
        }
    }
    Ok(())
}

/// The errors of the inter-prism distances over time.
fn log_distance_errors(recording: &mut Chunks, answer: &Answer, time_s: &[f64]) -> Result<()> {
    for (pair, (a, b)) in PAIRS.into_iter().enumerate() {
        let name = format!("{}{}", a + 1, b + 1);
        let path = format!("{DISTANCE_ERRORS}/{name}");
        recording.log_static(
            path.as_str(),
            &SeriesPoints::new().with_colors([palette::PAIRS[pair]]).with_names([name]),
        )?;
        recording.send_columns(
            path,
            time_column(time_s),
            Scalars::new(answer.evaluation.distance_errors_mm[pair].iter().copied())
                .columns_of_unit_batches()?,
        )?;
    }
    Ok(())
}

/// What the outlier filter looks at: the rates of a station from each reading to the next.
fn log_rates(recording: &mut Chunks, station: usize, track: &Track) -> Result<()> {
    let steps = track.measurements.windows(2);
    let time_s: Vec<f64> = steps.clone().map(|pair| pair[1].time_s).collect();
    let rates: Vec<Rates> = steps.map(|pair| rates(&pair[0], &pair[1])).collect();
    let of: [fn(&Rates) -> f64; 3] =
        [|r| r.range_m_per_s, |r| r.azimuth_deg_per_s, |r| r.zenith_deg_per_s];
    for (rate, of) in RATES.iter().zip(of) {
        let name = format!("station {}", station + 1);
        let path = format!("{}/station_{}", rate.entity, station + 1);
        let series =
            SeriesPoints::new().with_colors([palette::STATIONS[station]]).with_names([name]);
        recording.log_static(path.as_str(), &series)?;
        recording.send_columns(
            path,
            time_column(&time_s),
            Scalars::new(rates.iter().map(of)).columns_of_unit_batches()?,
        )?;
    }
    Ok(())
}

/// Points that are as large on the screen from anywhere: a drive is a hundred metres, and its readings millimetres
/// apart.
fn points(
    positions: impl IntoIterator<Item = [f32; 3]>,
    colour: Rgb,
    radius_points: f32,
) -> Points3D {
    let radius = Radius::new_ui_points(radius_points);
    Points3D::new(positions).with_colors([colour]).with_radii([radius])
}

fn time_column(time_s: &[f64]) -> TimeColumn {
    TimeColumn::new_timestamp_secs_since_epoch("time", time_s.iter().copied())
}
