//! `resect evaluate`: errors of trajectories of other systems against a deployment or another trajectory.

use std::path::PathBuf;

use clap::Args;

use super::judging_args::JudgingArguments;
use super::output::{advised, is_standard_output, spare, write};
use super::remedy_flags::unjudged_flag;
use super::settings_args::AnswerArguments;
use super::truth_args::TruthArguments;
use super::{Failure, print};
use resect_core::analysis::Analyst;
use resect_io::file_mark::used_files;
use resect_report::{estimates, svg};
use resect_tools::estimates::judge;

#[derive(Args)]
pub struct EvaluateArguments {
    /// Trajectories to evaluate: TUM, EuRoC, KITTI (with times.txt beside it), CSV with a header, bags with Odometry, PoseStamped or NavSatFix, RTKLIB
    /// (.pos), NMEA
    #[arg(required = true, value_name = "ESTIMATE")]
    trajectory: Vec<PathBuf>,
    /// Ground truth: a folder or file with the stations' tracks, or a trajectory in any format of the estimates. It may have
    /// orientations or positions only, and be dense or a few surveyed points. Given three times or more: GNSS solutions of antennas of one body
    #[arg(long, required = true, value_name = "PATH")]
    against: Vec<PathBuf>,
    #[command(flatten)]
    truth: TruthArguments,
    #[command(flatten)]
    judging: JudgingArguments,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Write a line for each epoch: its error, and σ of the ground truth
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write the table of errors for LaTeX
    #[arg(long, value_name = "FILE")]
    latex: Option<PathBuf>,
    /// Write a plot of the errors over time
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    #[command(flatten)]
    settings: AnswerArguments,
}

/// Width of the plot (points).
const WIDTH: f32 = 900.0;

pub fn run(arguments: &EvaluateArguments) -> Result<(), Failure> {
    let read_estimates = arguments.judging.read_each(&arguments.trajectory)?;
    let settings = arguments.settings.settings()?;
    let deployment = arguments.truth.open(&arguments.against, arguments.settings.extras())?;
    let analysis = Analyst::new(deployment.clone()).run(&settings);
    let truth = arguments.truth.ground_truth(&deployment, &analysis)?;
    let judgement = judge(&truth, read_estimates);
    if judgement.judged.is_empty() {
        let whys: Vec<String> = judgement
            .unjudged
            .iter()
            .map(|(_, why)| advised(why, unjudged_flag(why)).to_string())
            .collect();
        return Err(Failure::Input(anyhow::Error::msg(whys.join("; "))));
    }
    let start_s = truth.start_s().unwrap_or_default();
    let picture = || svg::to_svg(&estimates::draw(&judgement, start_s, WIDTH), svg::Colours::Light);
    let files: [(&Option<PathBuf>, &dyn Fn() -> String); 3] = [
        (&arguments.csv, &|| estimates::csv(&judgement)),
        (&arguments.latex, &|| estimates::latex(&judgement)),
        (&arguments.svg, &picture),
    ];
    for (file, text) in files {
        if let Some(file) = file {
            let read = arguments.trajectory.iter().chain(&arguments.against);
            spare(file, used_files(&deployment).chain(read.map(|path| &**path)))?;
            write(file, text())?;
        }
    }
    let outs = [&arguments.csv, &arguments.latex, &arguments.svg];
    if outs.into_iter().flatten().any(|out| is_standard_output(out)) {
        return Ok(());
    }
    Ok(print(&if arguments.json {
        format!("{:#}\n", estimates::json(&truth, &judgement))
    } else {
        estimates::text(&truth, &judgement)
    })?)
}
