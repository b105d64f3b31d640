//! `resect report`: verdict, transforms, residuals and the data behind them, as one HTML page.

use std::iter::zip;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;

use super::judging_args::JudgingArguments;
use super::output::{is_standard_output, spare, write};
use super::settings_args::AnswerArguments;
use super::{Failure, load_each, print};
use resect_core::analysis::{Analyst, Settings};
use resect_core::deployment::Deployment;
use resect_io::error::OpenError;
use resect_io::estimate_file;
use resect_io::file_mark::marks_of;
use resect_report::of_run;
use resect_report::report;
use resect_report::report::Chapter;
use resect_tools::estimates::{EstimatedTrajectory, GroundTruth, Options, judge};

#[derive(Args)]
pub struct ReportArguments {
    /// Folders or files with the stations' tracks
    #[arg(required = true)]
    path: Vec<PathBuf>,
    /// HTML file to write; - for standard output
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Trajectory of another system to evaluate against the deployment, as `resect evaluate` does; may be repeated
    #[arg(long, value_name = "ESTIMATE")]
    judge: Vec<PathBuf>,
    #[command(flatten)]
    judging: JudgingArguments,
    #[command(flatten)]
    settings: AnswerArguments,
}

/// Writes the report. A deployment with an error does not prevent the others; if all
/// fail, the page still states the reasons, so that nobody mistakes an older page for it.
pub fn run(arguments: &ReportArguments) -> Result<(), Failure> {
    let settings = arguments.settings.settings()?;
    if !arguments.judge.is_empty() && arguments.path.len() > 1 {
        let line = "--judge allows one deployment; write a report for each".to_owned();
        return Err(Failure::Usage(line));
    }
    if arguments.judge.is_empty() && arguments.judging.are_given() {
        let line = "--align, --time-offset and --body need --judge; give it too";
        return Err(Failure::Usage(line.to_owned()));
    }
    let mut estimates = Vec::new();
    let options = arguments.judging.options_of_each(arguments.judge.len())?;
    for (path, options) in arguments.judge.iter().zip(options) {
        estimates.extend(estimate_file::read(path)?.into_iter().map(|one| (one, options)));
    }
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
