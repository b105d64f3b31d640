//! `resect calibrate`: the answer as text or JSON.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde_json::Value;

use super::settings_args::SettingsArguments;
use super::{Failure, load, print};
use crate::analysis::Analyst;
use crate::export::{json, text};

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MethodName {
    InterPrism,
}

#[derive(Args)]
pub struct Arguments {
    /// Folder or file with the stations' tracks
    path: PathBuf,
    /// Calibration method; may be given several times
    #[arg(long, value_enum)]
    method: Vec<MethodName>,
    /// Print one JSON object (a list for several methods)
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    settings: SettingsArguments,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let settings = arguments.settings.settings()?;
    let (deployment, load_ms) = load(&arguments.path, arguments.settings.rig.as_deref())?;
    let deployment = arguments.settings.adjust(deployment)?;
    let analysis = Analyst::new(deployment.clone()).run(&settings);
    let answer = analysis.answer.clone()?;
    if arguments.json {
        let object = json::calibration(&deployment, &analysis, &answer, load_ms);
        let several = arguments.method.len() > 1;
        let value =
            if several { Value::Array(vec![object; arguments.method.len()]) } else { object };
        print(&format!("{value:#}\n"))?;
    } else {
        print(&text::calibration(&deployment, &analysis, &answer))?;
    }
    Ok(())
}
