//! `resect trajectory`: the vehicle's poses in six degrees of freedom.

use std::path::PathBuf;

use clap::Args;

use super::output::spare;
use super::settings_args::AnswerArguments;
use super::{Failure, load, print};
use crate::analysis::Analyst;
use crate::atomic;
use crate::deployment::file_mark::used_files;
use crate::evaluation::vehicle::{LARGEST_POSE_ERROR_M, NoTrajectory, trajectory_by};
use crate::export::tum;

#[derive(Args)]
pub struct Arguments {
    /// Folder or file with the stations' tracks
    path: PathBuf,
    /// File to write: TUM (timestamp tx ty tz qx qy qz qw), or CSV with the covariance if it ends in .csv; TUM on the
    /// terminal if none
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Leave out epochs with an inter-prism error above this (mm)
    #[arg(long, value_name = "MM", default_value_t = 1e3 * LARGEST_POSE_ERROR_M, allow_negative_numbers = true)]
    max_error: f64,
    #[command(flatten)]
    settings: AnswerArguments,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let settings = arguments.settings.settings()?;
    if !(arguments.max_error > 0.0 && arguments.max_error.is_finite()) {
        let line = format!("--max-error is {} mm; it must be above zero", arguments.max_error);
        return Err(Failure::Usage(line));
    }
    let (deployment, _) = load(&arguments.path, arguments.settings.extras())?;
    let analysis = Analyst::new(deployment.clone()).run(&settings);
    let answer = analysis.answer.clone()?;
    let (trajectory, frame) = trajectory_by(
        &deployment,
        analysis.triplets(),
        analysis.offer.targets,
        &answer.calibration,
        arguments.max_error / 1e3,
    )
    .map_err(|why| match why {
        NoTrajectory::NoRig(_) => anyhow::anyhow!("{why} (--rig)"),
        _ => why.into(),
    })?;
    if trajectory.poses.is_empty() {
        return Err(Failure::Input(anyhow::anyhow!(
            "{}: no pose: all {} epochs have an inter-prism error above {} mm; check the distances, or raise --max-error",
            deployment.name,
            trajectory.dropped,
            arguments.max_error,
        )));
    }
    let calibration = &answer.calibration;
    let header = format!(
        "{}: frame of station 1, by {}, verdict {}; vehicle: {}",
        deployment.name,
        calibration.method.in_words(),
        calibration.verdict_in_words(),
        frame.in_words(),
    );
    let Some(file) = &arguments.out else {
        return Ok(print(&tum::tum(&trajectory, &header))?);
    };
    let csv = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"));
    let text = if csv { tum::csv(&trajectory) } else { tum::tum(&trajectory, &header) };
    spare(file, used_files(&deployment))?;
    atomic::write(file, text)?;
    print(&format!(
        "{}: {} poses, {} epochs dropped (inter-prism error above {} mm)\n\
         frame of the poses: station 1; of the vehicle: {}\n\
         by {}, verdict {}\n",
        file.display(),
        trajectory.poses.len(),
        trajectory.dropped,
        arguments.max_error,
        frame.in_words(),
        calibration.method.in_words(),
        calibration.verdict_in_words(),
    ))?;
    if let Some(sigma) = trajectory.middle_sigma() {
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
