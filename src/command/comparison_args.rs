//! One comparison of estimates with a ground truth: the arguments that name both, and the judgement.

use std::path::PathBuf;

use clap::Args;

use super::Failure;
use super::frame_times::{frame_times, rate};
use super::judging_args::JudgingArguments;
use super::settings_args::AnswerArguments;
use super::truth_args::TruthArguments;
use resect_core::analysis::Analyst;
use resect_core::deployment::Deployment;
use resect_io::estimate_file::{self, NumberedTimes, poses_without_times, read_frames};
use resect_tools::estimates::{
    Association, Delta, EstimatedTrajectory, EstimatesJudgement, GroundTruth, Options,
    RelativeOptions, judge_motions,
};

#[derive(Args)]
pub struct ComparisonArguments {
    /// Trajectories to evaluate: TUM, EuRoC, KITTI (with times.txt beside it, or by number), CSV with a header, bags with Odometry, PoseStamped or NavSatFix, RTKLIB
    /// (.pos), NMEA
    #[arg(required_unless_present = "drives", value_name = "ESTIMATE")]
    pub trajectory: Vec<PathBuf>,
    /// Topic in a bag of several trajectories; several times for several of them. Without it, all topics but that of the ground truth
    #[arg(long, value_name = "TOPIC")]
    topic: Vec<String>,
    /// Ground truth: a folder or file with the stations' tracks, or a trajectory in any format of the estimates. It may have
    /// orientations or positions only, and be dense or a few surveyed points. Given three times or more: GNSS solutions of antennas of one body
    #[arg(long, required_unless_present = "drives", value_name = "PATH")]
    pub against: Vec<PathBuf>,
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
    #[command(flatten)]
    settings: AnswerArguments,
}

/// Names of the estimates of a drive, and those that cannot be read, each with the reason.
#[derive(Default)]
pub struct NamedEstimates {
    pub names: Vec<String>,
    pub unreadable: Vec<(String, String)>,
}

/// Receives a judgement with its ground truth, and the deployment or trajectory that was opened for it.
pub type JudgementReceiver<'a> =
    &'a mut dyn FnMut(&GroundTruth<'_>, EstimatesJudgement, &Deployment) -> Result<(), Failure>;

impl ComparisonArguments {
    /// Judges the estimates. With names they have these instead of those of their files, and those that cannot be read are listed.
    pub fn judge(
        &self,
        named: Option<&mut NamedEstimates>,
        receive: JudgementReceiver<'_>,
    ) -> Result<(), Failure> {
        if let (Some(from_s), Some(to_s)) = (self.from, self.to)
            && from_s >= to_s
        {
            return Err(Failure::Usage("--from must be before --to".to_owned()));
        }
        let frames = frame_times(&self.trajectory, &self.against, self.rate)?;
        let mut read_estimates = self.read_estimates(named, frames)?;
        let settings = self.settings.settings()?;
        let deployment = self.truth.open(&self.against, self.settings.extras(), frames)?;
        let analysis = Analyst::new(deployment.clone()).run(&settings);
        if let Some(truth) = &deployment.ground_truth {
            // A topic of a bag is not compared with itself.
            read_estimates
                .retain(|(estimate, _)| estimate.topic.is_none() || !estimate.is_same(truth));
        }
        let truth = self.truth.ground_truth(&deployment, &analysis)?;
        let start_s = truth.start_s().unwrap_or_default();
        for (_, options) in &mut read_estimates {
            options.from_s = self.from.map(|time_s| stamp_s(time_s, start_s));
            options.to_s = self.to.map(|time_s| stamp_s(time_s, start_s));
        }
        let judgement = judge_motions(&truth, read_estimates, self.motions());
        receive(&truth, judgement, &deployment)
    }

    /// Reads the estimates, each with its options. Poses that are compared by their numbers have equal clocks.
    fn read_estimates(
        &self,
        mut named: Option<&mut NamedEstimates>,
        frames: Option<NumberedTimes>,
    ) -> Result<Vec<(EstimatedTrajectory, Options)>, Failure> {
        let mut read_estimates = Vec::new();
        let options = self.judging.options_of_each(self.trajectory.len())?;
        for (index, (path, mut options)) in self.trajectory.iter().zip(options).enumerate() {
            let mut read = match frames.filter(|_| poses_without_times(path).is_some()) {
                Some(frames) => {
                    if !frames.is_given {
                        options.time_offset_s = options.time_offset_s.or(Some(0.0));
                        options.association = Association::Nearest;
                    }
                    read_frames(path, frames).map(|estimate| vec![estimate])
                }
                None => estimate_file::read(path),
            };
            if let Some(named) = &mut named {
                match &mut read {
                    Ok(read) if read.len() == 1 => read[0].name.clone_from(&named.names[index]),
                    Ok(_) => {}
                    Err(why) => {
                        named.unreadable.push((named.names[index].clone(), why.to_string()));
                        continue;
                    }
                }
            }
            let read = read?;
            read_estimates.extend(read.into_iter().map(|estimate| (estimate, options)));
        }
        self.keep_topics(&mut read_estimates)?;
        Ok(read_estimates)
    }

    /// Leaves out the trajectories of bags whose topics are not asked for.
    fn keep_topics(
        &self,
        estimates: &mut Vec<(EstimatedTrajectory, Options)>,
    ) -> Result<(), Failure> {
        if self.topic.is_empty() {
            return Ok(());
        }
        let topics: Vec<String> =
            estimates.iter().filter_map(|(estimate, _)| estimate.topic.clone()).collect();
        if let Some(missing) = self.topic.iter().find(|topic| !topics.contains(topic)) {
            let known = match topics.is_empty() {
                true => "no file has several topics".to_owned(),
                false => format!("the topics are {}", topics.join(", ")),
            };
            return Err(Failure::Usage(format!("--topic {missing}: {known}")));
        }
        estimates.retain(|(estimate, _)| {
            estimate.topic.as_ref().is_none_or(|topic| self.topic.contains(topic))
        });
        Ok(())
    }

    fn motions(&self) -> RelativeOptions {
        let usual = RelativeOptions::default();
        let deltas = if self.delta.is_empty() { usual.deltas } else { self.delta.clone() };
        RelativeOptions { deltas, all_pairs: self.all_pairs }
    }
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
