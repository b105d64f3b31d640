//! `resect trajectory`: the vehicle's poses in six degrees of freedom.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use nalgebra::Vector3;

use super::output::{advised, is_standard_output, kind_of, spare};
use super::remedy_flags::request_flag;
use super::settings_args::{AnswerArguments, metres};
use super::{Failure, load, print};
use resect_core::analysis::{Analysis, Analyst};
use resect_core::calibration::Calibration;
use resect_core::calibration::joint::prism_motion::PrismInstant;
use resect_core::deployment::Deployment;
use resect_core::evaluation::requested_trajectory::{
    LARGEST_RATE_HZ, RequestedMotion, TrajectoryRequest, requested_trajectory,
};
use resect_core::evaluation::trajectory::{PoseSigma, Trajectory};
use resect_core::evaluation::vehicle::{Instants, LARGEST_POSE_ERROR_M, PoseLimits};
use resect_core::network::MOST_STATIONS;
use resect_core::pipeline::Triplets;
use resect_core::statistics::median;
use resect_io::atomic;
use resect_io::file_mark::used_files;
use resect_report::trajectory as trajectory_file;
use resect_tools::estimates::{EstimatedTrajectory, GroundTruth, station_index};

#[derive(Args)]
pub struct TrajectoryArguments {
    /// Folder or file with the stations' tracks
    path: PathBuf,
    /// File to write: TUM (timestamp tx ty tz qx qy qz qw), or by its extension .csv with covariance and velocity, .mcap or .bag (ROS 1)
    /// with nav_msgs/Odometry, or .ply with time and σ; TUM on standard output if none, or -
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Omit epochs with an inter-prism error above this (mm)
    #[arg(long, value_name = "MM", default_value_t = 1e3 * LARGEST_POSE_ERROR_M, allow_negative_numbers = true)]
    max_error: f64,
    /// Omit epochs with a larger σ: in position (mm), and in orientation (°)
    #[arg(long, value_name = "MM,DEG", default_value = "50,3", allow_hyphen_values = true, value_parser = two_limits)]
    max_sigma: [f64; 2],
    /// Rate of evenly spaced poses (1/s), instead of ten wherever the joint estimate has a motion
    #[arg(long, value_name = "HZ", conflicts_with_all = ["at", "at_readings"], allow_negative_numbers = true)]
    pose_rate: Option<f64>,
    /// Poses at the times in the first column of this file (s; TUM, CSV), instead of ten a second (the joint estimate only)
    #[arg(long, value_name = "FILE")]
    at: Option<PathBuf>,
    /// Poses at the stamps of all readings, instead of ten a second (the joint estimate only)
    #[arg(long, conflicts_with = "at")]
    at_readings: bool,
    /// Poses of a sensor instead of the vehicle: its origin in the vehicle's frame (m), with parallel axes
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = metres)]
    lever_arm: Option<Vector3<f64>>,
    /// Positions of one station's prism in the station's own frame, as .tum or .csv with covariance. They need no calibration, and are
    /// the answer for a deployment with one station
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u8).range(1..=MOST_STATIONS as i64), conflicts_with_all = ["at", "at_readings", "lever_arm"])]
    station: Option<u8>,
    /// The frame of the poses: station 1's, or the one in which the control points were surveyed
    #[arg(long, value_enum, default_value_t = FrameArgument::Station1)]
    frame: FrameArgument,
    #[command(flatten)]
    settings: AnswerArguments,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FrameArgument {
    Station1,
    ControlPoints,
}

impl TrajectoryArguments {
    /// Returns the file to write; `None` for standard output.
    fn file(&self) -> Option<&Path> {
        self.out.as_deref().filter(|out| !is_standard_output(out))
    }

    fn limits(&self) -> PoseLimits {
        let [position_mm, orientation_deg] = self.max_sigma;
        let (position_m, orientation_rad) = (position_mm / 1e3, orientation_deg.to_radians());
        PoseLimits {
            inter_prism_error_m: self.max_error / 1e3,
            sigma: PoseSigma { position_m, orientation_rad },
            ..PoseLimits::default()
        }
    }
}

/// Reads two numbers above zero.
fn two_limits(text: &str) -> Result<[f64; 2], String> {
    let numbers = text.split(',').map(|number| number.trim().parse::<f64>());
    let numbers: Result<Vec<f64>, _> = numbers.collect();
    match numbers.as_deref() {
        Ok(&[a, b]) if a > 0.0 && b > 0.0 => Ok([a, b]),
        _ => Err("give two numbers above zero: mm and degrees".to_owned()),
    }
}

pub fn run(arguments: &TrajectoryArguments) -> Result<(), Failure> {
    let settings = arguments.settings.settings()?;
    check(arguments)?;
    // Before the slow steps.
    arguments.file().map(kind_of).transpose()?;
    let times_s = arguments.at.as_deref().map(times_of).transpose()?;
    let (deployment, _) = load(&arguments.path, arguments.settings.extras())?;
    let analysis = Analyst::new(deployment.clone()).run(&settings);
    let station = arguments.station.map(|number| station_index(&deployment, number.into()));
    let station = station.transpose()?;
    if let GroundTruth::Trajectory(track, _) = GroundTruth::of(&deployment, &analysis, station) {
        return one_station(arguments, &deployment, &track);
    }
    let answer = analysis.answer.clone()?;
    let reading_s = arguments
        .at_readings
        .then(|| reading_times_s(&deployment, analysis.triplets(), &answer.calibration));
    let instants = match (times_s.as_ref().or(reading_s.as_ref()), arguments.pose_rate) {
        (Some(times_s), _) => Instants::At(times_s),
        (None, Some(hz)) => Instants::Rate(hz),
        (None, None) => Instants::Usual,
    };
    let request = TrajectoryRequest {
        instants,
        limits: arguments.limits(),
        lever_arm_m: arguments.lever_arm,
        is_in_site_frame: arguments.frame == FrameArgument::ControlPoints,
    };
    let (triplets, followed) = (analysis.triplets(), &analysis.offer.followed);
    let requested =
        requested_trajectory(&deployment, triplets, followed, &answer.calibration, &request)
            .map_err(|why| advised(&why, request_flag(&why)))?;
    let frame_of_poses = requested.frame_in_words();
    let (trajectory, frame) = match requested.motion {
        RequestedMotion::Prism(positions) => {
            let placed = (&*positions, &*frame_of_poses);
            return one_prism(arguments, &deployment, &answer.calibration, placed);
        }
        RequestedMotion::Poses { trajectory, vehicle } => (trajectory, vehicle),
    };
    let frame_id = if requested.site.is_some() { "site" } else { trajectory_file::STATION1 };
    let vehicle = match arguments.lever_arm {
        None => frame.in_words().to_owned(),
        Some(at) => format!("at {}, {}, {} m in: {}", at.x, at.y, at.z, frame.in_words()),
    };
    let written =
        FramedTrajectory { trajectory: &trajectory, frame: &frame_of_poses, frame_id, vehicle };
    written.write(arguments, (&deployment, &analysis), &answer.calibration)
}

/// Refuses arguments out of their range.
fn check(arguments: &TrajectoryArguments) -> Result<(), Failure> {
    if !(arguments.max_error > 0.0 && arguments.max_error.is_finite()) {
        let line = format!("--max-error is {} mm; it must be above zero", arguments.max_error);
        return Err(Failure::Usage(line));
    }
    if let Some(hz) =
        arguments.pose_rate.filter(|hz| !(0.0..=LARGEST_RATE_HZ).contains(hz) || *hz == 0.0)
    {
        let line =
            format!("--pose-rate is {hz} Hz; it must be above 0 and {LARGEST_RATE_HZ} at most");
        return Err(Failure::Usage(line));
    }
    Ok(())
}

/// A trajectory with the names of its frames.
struct FramedTrajectory<'a> {
    trajectory: &'a Trajectory,
    /// The frame of the poses, in words, and its id.
    frame: &'a str,
    frame_id: &'a str,
    /// Reference point and axes of the vehicle, in words.
    vehicle: String,
}

impl FramedTrajectory<'_> {
    /// Writes the file, or prints the trajectory if no file is named.
    fn write(
        &self,
        arguments: &TrajectoryArguments,
        (deployment, analysis): (&Deployment, &Analysis),
        calibration: &Calibration,
    ) -> Result<(), Failure> {
        let Self { trajectory, frame, frame_id, vehicle } = self;
        let without = left_out(analysis, calibration);
        let header = format!(
            "{}: {frame}, by {}, verdict {}; vehicle: {}",
            deployment.name,
            calibration.method_in_words(),
            calibration.verdict_in_words(),
            vehicle,
        );
        let Some(file) = arguments.file() else {
            return Ok(print(&trajectory_file::tum(trajectory, &header))?);
        };
        let content = trajectory_file::file(kind_of(file)?, trajectory, &header, frame_id)
            .map_err(|why| anyhow::anyhow!("{}: {why}", file.display()))?;
        spare(file, used_files(deployment))?;
        atomic::write(file, content)?;
        print(&format!(
            "{}: {} poses, {}\n\
             poses in the {frame}; of the vehicle: {}\n\
             by {}, verdict {}\n{}",
            file.display(),
            trajectory.poses.len(),
            dropped(trajectory, arguments),
            vehicle,
            calibration.method_in_words(),
            calibration.verdict_in_words(),
            without,
        ))?;
        if let Some(sigma) = trajectory.median_sigma() {
            print(&format!(
                "typical σ, {}: {:.1} mm in position, {:.2} mrad in orientation\n",
                if calibration.joint().is_some() {
                    "from readings, calibration, clocks and rig"
                } else {
                    "from the spread of the inter-prism errors and given the calibration"
                },
                sigma.position_m * 1e3,
                sigma.orientation_rad * 1e3
            ))?;
        }
        Ok(())
    }
}

/// Writes the positions of one station's prism in the station's own frame, or prints them if no file is named.
fn one_station(
    arguments: &TrajectoryArguments,
    deployment: &Deployment,
    track: &EstimatedTrajectory,
) -> Result<(), Failure> {
    if track.poses.is_empty() {
        let why = "no interval is longer than τ_l; relax the outlier filter, τ_s or τ_l";
        return Err(Failure::Input(anyhow::anyhow!("{}: {why}", track.name)));
    }
    let header = format!("{}: positions of its prism in its own frame", track.name);
    let Some(file) = arguments.file() else {
        return Ok(print(&trajectory_file::station_tum(track, &header))?);
    };
    let content = trajectory_file::station_file(kind_of(file)?, track, &header)
        .map_err(|why| anyhow::anyhow!("{}: {why}", file.display()))?;
    spare(file, used_files(deployment))?;
    atomic::write(file, content)?;
    let sigmas_m = track.covariances.iter().map(|one| (one.position_m2.trace() / 3.0).sqrt());
    Ok(print(&format!(
        "{}: {} {header}\ntypical σ, from readings and the instrument's error sizes: {:.1} mm\n",
        file.display(),
        track.poses.len(),
        1e3 * median(sigmas_m).unwrap_or_default(),
    ))?)
}

/// Writes the positions of the one prism that all stations follow, or prints them if no file is named.
fn one_prism(
    arguments: &TrajectoryArguments,
    deployment: &Deployment,
    calibration: &Calibration,
    (positions, frame): (&[PrismInstant], &str),
) -> Result<(), Failure> {
    let by =
        format!("by {}, verdict {}", calibration.method_in_words(), calibration.verdict_in_words());
    let header = format!("{}: {frame}, {by}", deployment.name);
    let Some(file) = arguments.file() else {
        return Ok(print(&trajectory_file::prism_tum(positions, &header))?);
    };
    let content = trajectory_file::prism_file(kind_of(file)?, positions, &header)
        .map_err(|why| anyhow::anyhow!("{}: {why}", file.display()))?;
    spare(file, used_files(deployment))?;
    atomic::write(file, content)?;
    let sigma_m = |at: &PrismInstant| (at.position_covariance.trace() / 3.0).sqrt();
    let mut sigmas_m: Vec<f64> = positions.iter().map(sigma_m).collect();
    sigmas_m.sort_by(f64::total_cmp);
    Ok(print(&format!(
        "{}: {} positions of the one prism, {frame}\n{by}\n\
         typical σ, from readings, calibration and clocks: {:.1} mm\n",
        file.display(),
        positions.len(),
        1e3 * sigmas_m[sigmas_m.len() / 2],
    ))?)
}

/// Counts the epochs without a pose, by reason.
fn dropped(trajectory: &Trajectory, arguments: &TrajectoryArguments) -> String {
    let Trajectory { dropped, above_limit, too_uncertain, .. } = trajectory;
    let TrajectoryArguments { max_error, max_sigma: [position_mm, orientation_deg], .. } =
        arguments;
    let undetermined = dropped - above_limit - too_uncertain;
    let reasons = [
        (*above_limit, format!("with an inter-prism error above {max_error} mm")),
        (*too_uncertain, format!("with σ above {position_mm} mm or {orientation_deg}°")),
        (undetermined, "without a motion that the readings determine".to_owned()),
    ];
    let reasons = reasons.into_iter().filter(|(count, _)| *count > 0);
    let reasons: Vec<String> = reasons.map(|(count, why)| format!("{count} {why}")).collect();
    match reasons.is_empty() {
        true => "0 epochs dropped".to_owned(),
        false => {
            let epochs = if *dropped == 1 { "epoch" } else { "epochs" };
            format!("{dropped} {epochs} dropped ({})", reasons.join(", "))
        }
    }
}

/// Returns a line on the times that all stations observed without a pose; empty if there are none.
fn left_out(analysis: &Analysis, calibration: &Calibration) -> String {
    let Some(joint) = calibration.joint() else { return String::new() };
    let spans_s: Vec<[f64; 2]> = joint.solution.spans_s().collect();
    let has_motion = |time_s: &&f64| {
        let next = spans_s.partition_point(|span_s| span_s[1] < **time_s);
        spans_s.get(next).is_some_and(|span_s| span_s[0] <= **time_s)
    };
    let times_s = &analysis.triplets().time_s;
    let without: Vec<f64> = times_s.iter().copied().filter(|time_s| !has_motion(&time_s)).collect();
    let (Some(start_s), Some(first_s)) = (times_s.first(), without.first()) else {
        return String::new();
    };
    let triplets = if without.len() == 1 { "triplet" } else { "triplets" };
    format!(
        "no poses at {} {triplets}, whose readings contradict each other and were left out; the first is {:.1} s after the \
         first triplet\n",
        without.len(),
        first_s - start_s
    )
}

/// Returns the distinct times of all readings in station 1's clock, as far as the other clocks' offsets are estimated (s).
fn reading_times_s(
    deployment: &Deployment,
    triplets: &Triplets,
    calibration: &Calibration,
) -> Vec<f64> {
    let ends = triplets.time_s.first().zip(triplets.time_s.last());
    let middle_s = ends.map_or(0.0, |(first_s, last_s)| 0.5 * (first_s + last_s));
    let clocks = calibration.clocks();
    let late_s = |station: usize, time_s: f64| {
        clocks
            .as_ref()
            .map(|clocks| clocks[station])
            .map_or(0.0, |clock| clock.offset_s + clock.drift * (time_s - middle_s))
    };
    let readings = deployment.tracks.iter().enumerate().flat_map(|(station, track)| {
        let late_s = &late_s;
        track.measurements.iter().map(move |m| m.time_s - late_s(station, m.time_s))
    });
    let mut times_s: Vec<f64> = readings.collect();
    times_s.sort_by(f64::total_cmp);
    times_s.dedup();
    times_s
}

/// Reads the first number of each line of a file (s): TUM, CSV, or a bare list. Skips comments and one header.
fn times_of(path: &Path) -> Result<Vec<f64>, anyhow::Error> {
    let unreadable = |why: std::io::Error| anyhow::anyhow!("{}: {why}", path.display());
    // Reading a pipe would block until its writer closes it.
    let is_file = path.metadata().map_err(unreadable)?.is_file();
    anyhow::ensure!(is_file, "{}: not a regular file; give TUM or CSV", path.display());
    let text = std::fs::read_to_string(path).map_err(unreadable)?;
    let mut times_s = Vec::new();
    let mut headers = 0;
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with(['#', '%']) {
            continue;
        }
        let first = line.split([',', ';', ' ', '\t']).next().unwrap_or_default().trim();
        match first.parse::<f64>() {
            // EuRoC stamps are in nanoseconds.
            Ok(time) if time.is_finite() && time.abs() > 1e15 => times_s.push(1e-9 * time),
            Ok(time_s) if time_s.is_finite() => times_s.push(time_s),
            _ if times_s.is_empty() && headers == 0 => headers += 1,
            _ => anyhow::bail!(
                "{}:{}: the first column is not a time in seconds; give TUM or CSV with times in the first column",
                path.display(),
                index + 1
            ),
        }
    }
    anyhow::ensure!(!times_s.is_empty(), "{}: no times in this file", path.display());
    Ok(times_s)
}
