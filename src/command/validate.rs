//! `resect validate`: test of a calibration on other runs of its set-up.

use std::path::PathBuf;

use clap::Args;
use serde_json::Value;

use super::settings_args::AnswerArguments;
use super::{Failure, load_each, print};
use resect_core::analysis::Analyst;
use resect_report::json::read_earlier;
use resect_report::validation;
use resect_tools::validation::{drive_alone, validate};

#[derive(Args)]
pub struct ValidateArguments {
    /// Output of `calibrate --json`
    #[arg(value_name = "CALIBRATION.json")]
    calibration: PathBuf,
    /// Folders or files with the tracks of other runs
    #[arg(required = true)]
    path: Vec<PathBuf>,
    /// Print one JSON object (a list for several runs) with the verdict for scripts; the exit code is 0 for every verdict
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    settings: AnswerArguments,
}

pub fn run(arguments: &ValidateArguments) -> Result<(), Failure> {
    let settings = arguments.settings.settings()?;
    let earlier = read_earlier(&arguments.calibration)?;
    let mut found = Vec::new();
    for deployment in load_each(&arguments.path, &arguments.settings.extras()) {
        let deployment = drive_alone(&deployment?);
        let own = Analyst::new(deployment.clone()).run(&settings);
        found.push(validate(&earlier, &deployment, &own));
    }
    if arguments.json {
        let mut objects: Vec<Value> = found.iter().map(validation::json).collect();
        let value = if objects.len() == 1 { objects.remove(0) } else { Value::Array(objects) };
        print(&format!("{value:#}\n"))?;
    } else {
        let texts: Vec<String> = found.iter().map(validation::text).collect();
        print(&texts.join("\n"))?;
    }
    Ok(())
}
