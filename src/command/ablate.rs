//! `resect ablate`: the contribution of each module of the pipeline.

use clap::Args;

use super::choice::{METHODS, choice};
use super::progress_line::with_progress;
use super::study_args::StudyArguments;
use super::{Failure, print};
use resect_core::calibration::Method;
use resect_core::progress::Progress;
use resect_report::study;
use resect_tools::experiment::ablate;

#[derive(Args)]
pub struct AblateArguments {
    #[command(flatten)]
    study: StudyArguments,
    /// Reference method [default: as in the paper, static-gcp with control points, dynamic-gcp for one prism, else inter-prism]
    #[arg(long, value_parser = choice(METHODS), value_name = "METHOD")]
    reference: Option<Method>,
}

pub fn run(arguments: &AblateArguments) -> Result<(), Failure> {
    let settings = arguments.study.settings.settings()?;
    let splits = arguments.study.splits()?;
    let deployments = arguments.study.deployments()?;
    let reference = arguments.reference;
    let study = |it: &Progress| ablate(&deployments, &settings, reference, splits, it);
    let result = with_progress("calibrating without each module", study)?;
    if arguments.study.json {
        print(&format!("{:#}\n", study::json(&result)))?;
    } else {
        print(&study::table(&result))?;
    }
    arguments.study.write(&result)
}
