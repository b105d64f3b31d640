//! `resect evaluate`: errors of trajectories of other systems against a deployment or another trajectory, of one drive or of several.

use std::path::PathBuf;

use clap::Args;

use super::comparison_args::ComparisonArguments;
use super::drives::{DRIVES_HELP, DrivesFiles, write_drives};
use super::output::{advised, is_standard_output, spare, write};
use super::picture_file::{picture, picture_file};
use super::remedy_flags::unjudged_flag;
use super::{Failure, print};
use resect_core::deployment::Deployment;
use resect_io::file_mark::used_files;
use resect_report::estimates;
use resect_tools::estimates::{EstimatesJudgement, GroundTruth};

#[derive(Args)]
pub struct EvaluateArguments {
    #[command(flatten)]
    comparison: ComparisonArguments,
    /// Evaluate several drives, which this TOML file lists with their options: name, truth, estimates
    #[arg(
        long, value_name = "FILE", long_help = DRIVES_HELP,
        // The group of flattened arguments does not contain those around it.
        conflicts_with_all = [
            "trajectory", "topic", "against", "delta", "all_pairs", "rate", "from", "to", "JudgingArguments", "TruthArguments", "AnswerArguments", "map"
        ]
    )]
    drives: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Write a line for each epoch: its error, and σ of the ground truth; of several drives a line for each number, with σ
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write the table of errors for LaTeX
    #[arg(long, value_name = "FILE")]
    latex: Option<PathBuf>,
    /// Write a plot of the errors over time, of several drives a box plot (.svg, .png)
    #[arg(long, value_name = "FILE", value_parser = picture_file)]
    plot: Option<PathBuf>,
    /// Write a top view of the estimates over the ground truth, coloured by their errors (.svg, .png)
    #[arg(long, value_name = "FILE", value_parser = picture_file)]
    map: Option<PathBuf>,
}

/// Width of the pictures (points).
const WIDTH: f32 = 900.0;

pub fn run(arguments: &EvaluateArguments) -> Result<(), Failure> {
    if let Some(file) = &arguments.drives {
        let files = DrivesFiles {
            csv: arguments.csv.as_deref(),
            latex: arguments.latex.as_deref(),
            plot: arguments.plot.as_deref(),
        };
        return write_drives(file, &files, arguments.json);
    }
    arguments.comparison.judge(None, &mut |truth, judgement, deployment| {
        if judgement.judged.is_empty() {
            let whys: Vec<String> = judgement
                .unjudged
                .iter()
                .map(|(_, why)| advised(why, unjudged_flag(why)).to_string())
                .collect();
            return Err(Failure::Input(anyhow::Error::msg(whys.join("; "))));
        }
        write_files(arguments, truth, &judgement, deployment)?;
        if arguments.files().any(|(file, _)| is_standard_output(file)) {
            return Ok(());
        }
        Ok(print(&if arguments.json {
            format!("{:#}\n", estimates::json(truth, &judgement))
        } else {
            estimates::text(truth, &judgement)
        })?)
    })
}

/// A file that the command writes.
#[derive(Clone, Copy)]
enum Content {
    Csv,
    Latex,
    Plot,
    Map,
}

impl EvaluateArguments {
    /// Returns the files to write, each with its content.
    fn files(&self) -> impl Iterator<Item = (&PathBuf, Content)> {
        let files = [
            (&self.csv, Content::Csv),
            (&self.latex, Content::Latex),
            (&self.plot, Content::Plot),
            (&self.map, Content::Map),
        ];
        files.into_iter().filter_map(|(file, content)| Some((file.as_ref()?, content)))
    }
}

fn write_files(
    arguments: &EvaluateArguments,
    truth: &GroundTruth<'_>,
    judgement: &EstimatesJudgement,
    deployment: &Deployment,
) -> Result<(), Failure> {
    for (file, content) in arguments.files() {
        let ComparisonArguments { trajectory, against, .. } = &arguments.comparison;
        let read = trajectory.iter().chain(against);
        spare(file, used_files(deployment).chain(read.map(|path| &**path)))?;
        let bytes = match content {
            Content::Csv => estimates::csv(judgement).into_bytes(),
            Content::Latex => estimates::latex(judgement).into_bytes(),
            Content::Plot => {
                let start_s = truth.start_s().unwrap_or_default();
                picture(file, &estimates::draw(judgement, start_s, WIDTH))?
            }
            Content::Map => picture(file, &estimates::draw_map(judgement, WIDTH))?,
        };
        write(file, bytes)?;
    }
    Ok(())
}
