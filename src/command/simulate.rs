//! `resect simulate`: a deployment with known ground truth, as files.

mod error_args;
mod limits;

use resect_core::network::{MOST_STATIONS, USUAL_STATIONS};
use std::path::{Path, PathBuf};
use std::slice::from_mut;

use clap::Args;

use self::error_args::ErrorArguments;
use self::limits::{Limits, replace};
use super::choice::{PRESETS, choice};
use super::output::{kind_of, spare_file};
use super::{Failure, print};
use resect_core::geometry::ARCSECOND_RAD;
use resect_io::atomic;
use resect_io::simulation_files::write_folder;
use resect_report::trajectory as trajectory_file;
use resect_report::trajectory::FileKind;
use resect_tools::simulation::{Preset, Scenario, Simulated, simulate_scenario};

const TRUE_POSES_APART_S: f64 = 0.1;

#[derive(Args)]
pub struct SimulateArguments {
    /// Scenario: the drive and its surroundings
    #[arg(long, value_parser = choice(PRESETS))]
    preset: Preset,
    /// The same seed gives the same files
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Number of stations, 1 to 8; further ones stand around the path
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=MOST_STATIONS as i64))]
    stations: Option<u8>,
    /// Number of prisms on the vehicle, 1 to 8; stations share prisms if there are fewer prisms
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(u8).range(1..=MOST_STATIONS as i64))]
    prisms: Option<u8>,
    /// Folder to write into
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// File for the true poses of the vehicle, ten a second in the frame of station 1: .tum, .csv, .ply, .mcap or .bag
    #[arg(long, value_name = "FILE")]
    true_poses: Option<PathBuf>,
    /// Noise of the ranges, 1 σ (mm)
    #[arg(long, value_name = "MM")]
    range_noise: Option<f64>,
    /// Noise of both angles, 1 σ (arcseconds)
    #[arg(long, value_name = "ARCSEC")]
    angle_noise: Option<f64>,
    /// Share of readings with a gross error (0 to 1)
    #[arg(long, value_name = "SHARE")]
    outliers: Option<f64>,
    /// Lost locks of each station per minute
    #[arg(long, value_name = "PER_MIN")]
    lost_locks: Option<f64>,
    /// Intervals a minute in which each station follows a wrong prism
    #[arg(long, value_name = "PER_MIN")]
    wrong_targets: Option<f64>,
    /// Readings per second of each station
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// Time of the first reading of each station (ms); from the seed if not given
    #[arg(long, value_name = "MS,MS,MS", value_delimiter = ',')]
    stagger: Vec<f64>,
    /// Duration of the drive (s)
    #[arg(long, value_name = "S")]
    duration: Option<f64>,
    #[command(flatten)]
    errors: Box<ErrorArguments>,
}

pub fn run(arguments: &SimulateArguments) -> Result<(), Failure> {
    let scenario = scenario(arguments)?;
    let kind = arguments.true_poses.as_deref().map(kind_of).transpose()?;
    if let Some(file) =
        arguments.true_poses.as_deref().filter(|file| file.starts_with(&arguments.out))
    {
        let line = "would be read with the deployment; choose a file outside its folder";
        return Err(Failure::Usage(format!("{}: {line}", file.display())));
    }
    let simulated = simulate_scenario(&scenario, arguments.seed);
    write_folder(&simulated, &arguments.out)?;
    if let Some((file, kind)) = arguments.true_poses.as_deref().zip(kind) {
        write_true_poses(&simulated, file, kind)?;
    }
    print(&format!(
        "{}: {} readings ({} outliers, {} lost), {} control-point sets; the ground truth is in truth.toml\nnext: \
         resect calibrate {}\n",
        arguments.out.display(),
        simulated.records.len(),
        simulated.truth.outliers,
        simulated.truth.lost_readings,
        simulated.control_points.iter().filter(|set| !set.pillars).count(),
        arguments.out.display(),
    ))?;
    Ok(())
}

/// Writes the true poses of the vehicle.
fn write_true_poses(simulated: &Simulated, file: &Path, kind: FileKind) -> Result<(), Failure> {
    spare_file(file, [])?;
    let trajectory = simulated.true_trajectory(TRUE_POSES_APART_S);
    let prisms = simulated.truth.prisms_m.map(|at| format!("({}, {}, {})", at.x, at.y, at.z));
    let prisms = prisms.as_slice().join(", ");
    let header = format!(
        "true poses, preset {}, seed {}: frame of station 1 at set-up; vehicle: x ahead, y left, z up, prisms at {prisms} m",
        simulated.scenario.name, simulated.seed
    );
    let content = trajectory_file::file(kind, &trajectory, &header, trajectory_file::STATION1)
        .map_err(|why| anyhow::anyhow!("{}: {why}", file.display()))?;
    Ok(atomic::write(file, content)?)
}

/// Returns the preset with the changes of the options.
fn scenario(arguments: &SimulateArguments) -> Result<Scenario, Failure> {
    let scenario = arguments.preset.scenario();
    let stations = arguments.stations.map_or(USUAL_STATIONS, usize::from);
    let own_prisms = || match scenario.prisms() {
        1 => 1,
        prisms if arguments.stations.is_none() => prisms,
        _ => stations,
    };
    let prisms = arguments.prisms.map_or_else(own_prisms, usize::from);
    let mut scenario = scenario.with_network(stations, prisms);
    let noise = &mut scenario.noise;
    let mut stagger_s = vec![0.0; stations];
    let per_minute = Limits::up_to(60.0, 1.0);
    for (name, given, limits, to) in [
        (
            "range-noise",
            arguments.range_noise.as_slice(),
            Limits::up_to(1000.0, 1e-3),
            from_mut(&mut noise.range_sigma_m),
        ),
        (
            "angle-noise",
            arguments.angle_noise.as_slice(),
            Limits::up_to(3600.0, ARCSECOND_RAD),
            from_mut(&mut noise.angle_sigma_rad),
        ),
        (
            "outliers",
            arguments.outliers.as_slice(),
            Limits::up_to(1.0, 1.0),
            from_mut(&mut noise.outlier_share),
        ),
        (
            "lost-locks",
            arguments.lost_locks.as_slice(),
            per_minute,
            from_mut(&mut noise.lost_locks_per_minute),
        ),
        (
            "wrong-targets",
            arguments.wrong_targets.as_slice(),
            per_minute,
            from_mut(&mut noise.wrong_targets_per_minute),
        ),
        (
            "rate",
            arguments.rate.as_slice(),
            Limits { low: 0.1, high: 50.0, unit: 1.0 },
            from_mut(&mut scenario.rate_hz),
        ),
        (
            "duration",
            arguments.duration.as_slice(),
            Limits { low: 10.0, high: 20_000.0, unit: 1.0 },
            from_mut(&mut scenario.duration_s),
        ),
        ("stagger", &arguments.stagger, Limits::up_to(5000.0, 1e-3), &mut stagger_s),
    ] {
        replace(name, given, limits, to)?;
    }
    if !arguments.stagger.is_empty() {
        scenario.stagger_s = Some(stagger_s.into_iter().collect());
    }
    // Last, since errors occur within the duration of the drive.
    arguments.errors.apply(scenario, arguments.seed)
}
