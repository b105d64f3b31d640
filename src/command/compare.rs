//! `resect compare`: all methods that the data allows, by both metrics.

use clap::Args;

use super::progress_line::with_progress;
use super::remedy_flags::finding_line;
use super::study_args::StudyArguments;
use super::{Failure, print};
use resect_core::progress::Progress;
use resect_report::study;
use resect_tools::experiment::compare;

#[derive(Args)]
pub struct CompareArguments {
    #[command(flatten)]
    study: StudyArguments,
}

pub fn run(arguments: &CompareArguments) -> Result<(), Failure> {
    let settings = arguments.study.settings.settings()?;
    let splits = arguments.study.splits()?;
    let deployments = arguments.study.deployments()?;
    let study = |it: &Progress| compare(&deployments, &settings, splits, it);
    let result = with_progress("calibrating by each method", study)?;
    if arguments.study.json {
        print(&format!("{:#}\n", study::comparison_json(&result)))?;
    } else {
        print(&study::table(&result.study))?;
        print(&study::transforms_table(&result, finding_line))?;
    }
    arguments.study.write(&result.study)
}
