//! `resect evaluate`: errors of trajectories of other systems, with the deployment's own as ground truth.

use std::path::PathBuf;

use clap::Args;

use super::judging_args::JudgingArguments;
use super::output::{advised, spare};
use super::remedy_flags::unjudged_flag;
use super::settings_args::AnswerArguments;
use super::{Failure, load, print};
use resect_core::analysis::Analyst;
use resect_core::estimates::judge;
use resect_io::atomic;
use resect_io::estimate_file;
use resect_io::file_mark::used_files;
use resect_report::{estimates, svg};

#[derive(Args)]
pub struct EvaluateArguments {
    /// Trajectories to evaluate: TUM, EuRoC, KITTI (with times.txt beside it), CSV with a header, or bags with Odometry or PoseStamped
    #[arg(required = true, value_name = "ESTIMATE")]
    trajectory: Vec<PathBuf>,
    /// Folder or file with the stations' tracks: the ground truth
    #[arg(long, value_name = "PATH")]
    against: PathBuf,
    #[command(flatten)]
    judging: JudgingArguments,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Write a line for each epoch: its error, and σ of the ground truth
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write a plot of the errors over time
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    #[command(flatten)]
    settings: AnswerArguments,
}

/// Width of the plot (points).
const WIDTH: f32 = 900.0;

pub fn run(arguments: &EvaluateArguments) -> Result<(), Failure> {
    let settings = arguments.settings.settings()?;
    let mut read_estimates = Vec::new();
    let options = arguments.judging.options_of_each(arguments.trajectory.len())?;
    for (path, options) in arguments.trajectory.iter().zip(options) {
        read_estimates.extend(estimate_file::read(path)?.into_iter().map(|one| (one, options)));
    }
    let (deployment, _) = load(&arguments.against, arguments.settings.extras())?;
    let analysis = Analyst::new(deployment.clone()).run(&settings);
    let answer = analysis.answer.clone()?;
    let calibration = &answer.calibration;
    let judgement = judge(&deployment, &analysis, read_estimates);
    if judgement.judged.is_empty() {
        let whys: Vec<String> = judgement
            .unjudged
            .iter()
            .map(|(_, why)| advised(why, unjudged_flag(why)).to_string())
            .collect();
        return Err(Failure::Input(anyhow::Error::msg(whys.join("; "))));
    }
    let start_s = deployment.start_s().unwrap_or_default();
    let read_files =
        || used_files(&deployment).chain(arguments.trajectory.iter().map(|path| &**path));
    let picture = || svg::to_svg(&estimates::draw(&judgement, start_s, WIDTH), svg::Colours::Light);
    let files: [(&Option<PathBuf>, &dyn Fn() -> String); 2] =
        [(&arguments.csv, &|| estimates::csv(&judgement)), (&arguments.svg, &picture)];
    for (file, text) in files {
        if let Some(file) = file {
            spare(file, read_files())?;
            atomic::write(file, text())?;
        }
    }
    Ok(print(&if arguments.json {
        format!("{:#}\n", estimates::json(&deployment.name, calibration, &judgement))
    } else {
        estimates::text(&deployment.name, calibration, &judgement, start_s)
    })?)
}
