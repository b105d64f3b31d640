//! `resect sweep`: dependence of the errors on one threshold.

use clap::Args;

use super::choice::{METHODS, PARAMETERS, choice};
use super::progress_line::with_progress;
use super::study_args::StudyArguments;
use super::{Failure, print};
use resect_core::calibration::Method;
use resect_core::progress::Progress;
use resect_report::study;
use resect_tools::experiment::{Parameter, Sweep, sweep, sweep_answers};

#[derive(Args)]
pub struct SweepArguments {
    #[command(flatten)]
    study: StudyArguments,
    /// Parameter to vary
    #[arg(long, value_parser = choice(PARAMETERS))]
    parameter: Parameter,
    /// First value, in the unit of the setting
    #[arg(long, allow_negative_numbers = true)]
    from: f64,
    /// Last value
    #[arg(long, allow_negative_numbers = true)]
    to: f64,
    /// Number of values, both ends included
    #[arg(long, default_value_t = 11)]
    steps: usize,
    /// Reference method [default: as in the paper, static-gcp with control points, dynamic-gcp for one prism, else inter-prism]
    #[arg(long, value_parser = choice(METHODS), value_name = "METHOD")]
    reference: Option<Method>,
    /// Calibrate for each value by method D (C with one prism) and by the joint estimate, and judge both on the same triplets
    #[arg(long, conflicts_with_all = ["reference", "splits"])]
    answers: bool,
}

pub fn run(arguments: &SweepArguments) -> Result<(), Failure> {
    let settings = arguments.study.settings.settings()?;
    let splits = arguments.study.splits()?;
    let SweepArguments { parameter, from, to, steps, .. } = *arguments;
    let range = Sweep { parameter, from, to, steps };
    range.check(&settings.pipeline).map_err(Failure::Usage)?;
    let deployments = arguments.study.deployments()?;
    let reference = arguments.reference;
    let study = |it: &Progress| {
        if arguments.answers {
            sweep_answers(&deployments, &settings, &range, it)
        } else {
            sweep(&deployments, &settings, &range, reference, splits, it)
        }
    };
    let result = with_progress("sweeping", study)?;
    if arguments.study.json {
        print(&format!("{:#}\n", study::json(&result)))?;
    } else {
        print(&study::table(&result))?;
    }
    arguments.study.write(&result)
}
