//! `resect calibrate`: the calibration as text or JSON.

use std::path::PathBuf;

use clap::Args;
use serde_json::Value;

use super::remedy_flags::finding_line;
use super::settings_args::AnswerArguments;
use super::{Failure, load, print};
use resect_core::analysis::Analyst;
use resect_report::{json, text, trace};

#[derive(Args)]
pub struct CalibrateArguments {
    /// Folder or file with the stations' tracks
    path: PathBuf,
    /// Print one JSON object (a list for several methods)
    #[arg(long)]
    json: bool,
    /// Add the trace of the joint estimate: a row for each step of the solver
    #[arg(long)]
    trace: bool,
    #[command(flatten)]
    settings: AnswerArguments,
}

pub fn run(arguments: &CalibrateArguments) -> Result<(), Failure> {
    let settings = arguments.settings.settings_of_each()?;
    let (deployment, load_ms) = load(&arguments.path, arguments.settings.extras())?;
    let mut analyst = Analyst::new(deployment.clone());
    let several = settings.len() > 1;
    let mut objects = Vec::new();
    for settings in settings {
        let analysis = analyst.run(&settings);
        let answer = analysis.answer.clone()?;
        let trace = answer.calibration.trace().filter(|_| arguments.trace);
        if arguments.json {
            let mut object = json::calibration(&deployment, &analysis, &answer, load_ms);
            if let Some(trace) = trace {
                object["trace"] = trace::json(trace);
            }
            objects.push(object);
        } else {
            print(&text::calibration(&deployment, &analysis, &answer, finding_line))?;
            if let Some(trace) = trace {
                print(&format!("\n{}", trace::text(trace)))?;
            }
            print(&text::durations(&analysis, &answer))?;
        }
    }
    if let (true, Some(first)) = (arguments.json, objects.first()) {
        let value = if several { Value::Array(objects) } else { first.clone() };
        print(&format!("{value:#}\n"))?;
    }
    Ok(())
}
