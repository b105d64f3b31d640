//! `resect evaluate`: errors of trajectories of other systems against a deployment or another trajectory.

use std::path::PathBuf;

use clap::Args;

use super::frame_times::{frame_times, rate};
use super::judging_args::JudgingArguments;
use super::output::{advised, is_standard_output, spare, write};
use super::picture_file::{picture, picture_file};
use super::remedy_flags::unjudged_flag;
use super::settings_args::AnswerArguments;
use super::truth_args::TruthArguments;
use super::{Failure, print};
use resect_core::analysis::Analyst;
use resect_core::deployment::Deployment;
use resect_io::estimate_file::{self, NumberedTimes, poses_without_times, read_frames};
use resect_io::file_mark::used_files;
use resect_report::estimates;
use resect_tools::estimates::{
    Association, Delta, EstimatedTrajectory, EstimatesJudgement, GroundTruth, Options,
    RelativeOptions, judge_motions, station_index,
};

#[derive(Args)]
pub struct EvaluateArguments {
    /// Trajectories to evaluate: TUM, EuRoC, KITTI (with times.txt beside it, or by number), CSV with a header, bags with Odometry, PoseStamped or NavSatFix, RTKLIB
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
    /// Size of the motions of the RPE: m of the path along the estimate, s, f (poses) or deg (of rotation); several times for several sizes.
    /// Without it: 1, 5, 20 and 100 m
    #[arg(long, value_name = "N[m|s|f|deg]")]
    delta: Vec<Delta>,
    /// RPE of the motions from each pose, up to 10 % off the size; otherwise motions follow each other without overlap
    #[arg(long)]
    all_pairs: bool,
    /// Rate of KITTI poses without times (Hz). Without it they are compared by their numbers, if all files have as many
    #[arg(long, value_name = "HZ", value_parser = rate)]
    rate: Option<f64>,
    /// Compare from this time on: seconds since the start of the ground truth, or a stamp (from 1000000 on)
    #[arg(long, value_name = "TIME", allow_negative_numbers = true, value_parser = time)]
    from: Option<f64>,
    /// Compare up to this time
    #[arg(long, value_name = "TIME", allow_negative_numbers = true, value_parser = time)]
    to: Option<f64>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Write a line for each epoch: its error, and σ of the ground truth
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write the table of errors for LaTeX
    #[arg(long, value_name = "FILE")]
    latex: Option<PathBuf>,
    /// Write a plot of the errors over time (.svg, .png)
    #[arg(long, value_name = "FILE", value_parser = picture_file)]
    plot: Option<PathBuf>,
    /// Write a top view of the estimates over the ground truth, coloured by their errors (.svg, .png)
    #[arg(long, value_name = "FILE", value_parser = picture_file)]
    map: Option<PathBuf>,
    #[command(flatten)]
    settings: AnswerArguments,
}

/// Width of the pictures (points).
const WIDTH: f32 = 900.0;

pub fn run(arguments: &EvaluateArguments) -> Result<(), Failure> {
    let frames = frame_times(&arguments.trajectory, &arguments.against, arguments.rate)?;
    let mut read_estimates = arguments.read_estimates(frames)?;
    let settings = arguments.settings.settings()?;
    if let (Some(from_s), Some(to_s)) = (arguments.from, arguments.to)
        && from_s >= to_s
    {
        return Err(Failure::Usage("--from must be before --to".to_owned()));
    }
    let deployment =
        arguments.truth.open(&arguments.against, arguments.settings.extras(), frames)?;
    let analysis = Analyst::new(deployment.clone()).run(&settings);
    let number = arguments.truth.truth_station;
    let station = number.map(|number| station_index(&deployment, number.into()));
    let station = station.transpose()?;
    let truth = GroundTruth::of(&deployment, &analysis, station);
    if let GroundTruth::Deployment { .. } = truth {
        analysis.answer.clone()?;
    }
    let start_s = truth.start_s().unwrap_or_default();
    for (_, options) in &mut read_estimates {
        options.from_s = arguments.from.map(|time_s| stamp_s(time_s, start_s));
        options.to_s = arguments.to.map(|time_s| stamp_s(time_s, start_s));
    }
    let judgement = judge_motions(&truth, read_estimates, arguments.motions());
    if judgement.judged.is_empty() {
        let whys: Vec<String> = judgement
            .unjudged
            .iter()
            .map(|(_, why)| advised(why, unjudged_flag(why)).to_string())
            .collect();
        return Err(Failure::Input(anyhow::Error::msg(whys.join("; "))));
    }
    write_files(arguments, &truth, &judgement, &deployment)?;
    if arguments.files().any(|(file, _)| is_standard_output(file)) {
        return Ok(());
    }
    Ok(print(&if arguments.json {
        format!("{:#}\n", estimates::json(&truth, &judgement))
    } else {
        estimates::text(&truth, &judgement)
    })?)
}

/// Smallest number that is a stamp (s); smaller ones are seconds since the start. No drive lasts so long.
const SMALLEST_STAMP_S: f64 = 1e6;

/// Returns the stamp of a time that may be seconds since the start.
fn stamp_s(time_s: f64, start_s: f64) -> f64 {
    if time_s >= SMALLEST_STAMP_S { time_s } else { start_s + time_s }
}

fn time(text: &str) -> Result<f64, String> {
    let time_s = text.trim().parse().ok().filter(|time_s: &f64| time_s.is_finite());
    time_s.ok_or_else(|| "give a number of seconds".to_owned())
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
    /// Reads the estimates, each with its options. Poses that are compared by their numbers have equal clocks.
    fn read_estimates(
        &self,
        frames: Option<NumberedTimes>,
    ) -> Result<Vec<(EstimatedTrajectory, Options)>, Failure> {
        let mut read_estimates = Vec::new();
        let options = self.judging.options_of_each(self.trajectory.len())?;
        for (path, mut options) in self.trajectory.iter().zip(options) {
            match frames.filter(|_| poses_without_times(path).is_some()) {
                Some(frames) => {
                    if !frames.is_given {
                        options.time_offset_s = options.time_offset_s.or(Some(0.0));
                        options.association = Association::Nearest;
                    }
                    read_estimates.push((read_frames(path, frames)?, options));
                }
                None => {
                    let read = estimate_file::read(path)?;
                    read_estimates.extend(read.into_iter().map(|estimate| (estimate, options)));
                }
            }
        }
        Ok(read_estimates)
    }

    fn motions(&self) -> RelativeOptions {
        let usual = RelativeOptions::default();
        let deltas = if self.delta.is_empty() { usual.deltas } else { self.delta.clone() };
        RelativeOptions { deltas, all_pairs: self.all_pairs }
    }

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
        let read = arguments.trajectory.iter().chain(&arguments.against);
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
