//! `resect report`: verdict, transforms, residuals and the data behind them, as one HTML page.

use std::iter::zip;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;

use super::judging_args::JudgingArguments;
use super::output::{is_standard_output, spare, write};
use super::settings_args::AnswerArguments;
use super::truth_args::TruthArguments;
use super::{Failure, load_each, print};
use resect_core::analysis::{Analyst, Settings};
use resect_core::deployment::Deployment;
use resect_io::error::OpenError;
use resect_io::file_mark::{FileMark, marks_of, used_files};
use resect_report::of_run;
use resect_report::report;
use resect_report::report::{Chapter, EvaluationChapter};
use resect_tools::estimates::{EstimatedTrajectory, GroundTruth, Options, judge};

#[derive(Args)]
pub struct ReportArguments {
    /// Folders or files with the stations' tracks; with --against, trajectories of other systems
    #[arg(required = true)]
    path: Vec<PathBuf>,
    /// HTML file to write; - for standard output
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Trajectory of another system to evaluate against the deployment, as `resect evaluate` does; may be repeated
    #[arg(long, value_name = "ESTIMATE")]
    judge: Vec<PathBuf>,
    /// Ground truth of the trajectories, as in `resect evaluate`: a deployment, or a trajectory
    #[arg(long, value_name = "PATH", conflicts_with = "judge")]
    against: Vec<PathBuf>,
    #[command(flatten)]
    truth: TruthArguments,
    #[command(flatten)]
    judging: JudgingArguments,
    #[command(flatten)]
    settings: AnswerArguments,
}

/// Writes the report. A deployment with an error does not prevent the others; if all
/// fail, the page still states the reasons, so that nobody mistakes an older page for it.
pub fn run(arguments: &ReportArguments) -> Result<(), Failure> {
    let settings = arguments.settings.settings()?;
    if !arguments.against.is_empty() {
        return evaluation(arguments, &settings);
    }
    if arguments.truth.are_given() {
        let line = "--antenna and the flags --truth-… need --against; give it too";
        return Err(Failure::Usage(line.to_owned()));
    }
    if !arguments.judge.is_empty() && arguments.path.len() > 1 {
        let line = "--judge allows one deployment; write a report for each".to_owned();
        return Err(Failure::Usage(line));
    }
    if arguments.judge.is_empty() && arguments.judging.are_given() {
        let line = "--align, --time-offset and --body need --judge; give it too";
        return Err(Failure::Usage(line.to_owned()));
    }
    let estimates = arguments.judging.read_each(&arguments.judge)?;
    let opened = load_each(&arguments.path, &arguments.settings.extras());
    let chapters: Vec<Chapter> = zip(&arguments.path, opened)
        .map(|(path, opened)| chapter(path, opened, &settings, &estimates))
        .collect();
    let read = chapters.iter().flat_map(Chapter::files).map(|file| &file.path);
    let read = read.chain(&arguments.path).chain(&arguments.judge);
    spare(&arguments.out, read.map(PathBuf::as_path))?;
    write(&arguments.out, report::page(&chapters, of_run::date()))?;
    let file = arguments.out.display();
    let errors: Vec<String> = chapters.iter().filter_map(|c| c.answer().err()).collect();
    let (all, without) = (chapters.len(), errors.len());
    match &errors[..] {
        [only] if all == 1 => Err(Failure::Input(anyhow::anyhow!("{only}"))),
        [first, ..] if without == all => Err(Failure::Input(anyhow::anyhow!(
            "none of {all} deployments has an answer ({file} gives the reasons); the first: {first}"
        ))),
        _ if is_standard_output(&arguments.out) => Ok(()),
        _ => {
            let plural = if all == 1 { "" } else { "s" };
            let without = match without {
                0 => String::new(),
                _ => format!(", {without} of them without an answer"),
            };
            Ok(print(&format!("{file}: report on {all} deployment{plural}{without}\n"))?)
        }
    }
}

/// Writes the evaluation of trajectories against one ground truth.
fn evaluation(arguments: &ReportArguments, settings: &Settings) -> Result<(), Failure> {
    let estimates = arguments.judging.read_each(&arguments.path)?;
    let deployment = arguments.truth.open(&arguments.against, arguments.settings.extras(), None)?;
    let analysis = Box::new(Analyst::new(deployment.clone()).run(settings));
    let truth = arguments.truth.ground_truth(&deployment, &analysis)?;
    let judgement = Arc::new(judge(&truth, estimates));
    let evaluated = judgement.judged.len();
    let mut files = marks_of(&deployment);
    let read = || arguments.path.iter().chain(&arguments.against).map(PathBuf::as_path);
    spare(&arguments.out, used_files(&deployment).chain(read()))?;
    let chapter = match truth {
        GroundTruth::Deployment { .. } => {
            let deployment = Arc::clone(&deployment);
            Chapter::Analysed { deployment, analysis, files, judgement: Some(judgement) }
        }
        GroundTruth::Trajectory(..) => {
            let estimates = arguments.path.iter().filter_map(|path| FileMark::of(path).ok());
            files.extend(estimates);
            Chapter::Evaluated(Box::new(EvaluationChapter::of(&truth, judgement, files)))
        }
    };
    write(&arguments.out, report::page(&[chapter], of_run::date()))?;
    let file = arguments.out.display();
    if evaluated == 0 {
        let line = format!("none of the trajectories could be evaluated; {file} gives the reasons");
        return Err(Failure::Input(anyhow::Error::msg(line)));
    }
    if is_standard_output(&arguments.out) {
        return Ok(());
    }
    let plural = if evaluated == 1 { "y" } else { "ies" };
    Ok(print(&format!("{file}: report on {evaluated} trajector{plural}\n"))?)
}

fn chapter(
    path: &Path,
    opened: Result<Arc<Deployment>, OpenError>,
    settings: &Settings,
    estimates: &[(EstimatedTrajectory, Options)],
) -> Chapter {
    match opened {
        Ok(deployment) => {
            let analysis = Box::new(Analyst::new(deployment.clone()).run(settings));
            let files = marks_of(&deployment);
            let judged = || {
                let (deployment, analysis) = (&*deployment, &*analysis);
                judge(&GroundTruth::of(deployment, analysis, None), estimates.to_vec())
            };
            let judgement = (!estimates.is_empty()).then(|| Arc::new(judged()));
            Chapter::Analysed { deployment, analysis, files, judgement }
        }
        Err(error) => {
            Chapter::Unopened { path: path.display().to_string(), error: error.to_string() }
        }
    }
}
