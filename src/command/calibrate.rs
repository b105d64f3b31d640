//! `resect calibrate`: the answer as text or JSON.

use std::path::PathBuf;

use clap::Args;
use serde_json::Value;

use super::settings_args::SettingsArguments;
use super::{Failure, load, print};
use crate::analysis::Analyst;
use crate::calibration::Method;
use crate::export::{json, text};

#[derive(Args)]
pub struct Arguments {
    /// Folder or file with the stations' tracks
    path: PathBuf,
    /// Calibration method; may be given several times. Inter-prism if none, dynamic-gcp where all stations follow one
    /// prism
    #[arg(long, value_enum)]
    method: Vec<Method>,
    /// Print one JSON object (a list for several methods)
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    settings: SettingsArguments,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut settings = arguments.settings.settings()?;
    let (deployment, load_ms) = load(&arguments.path, arguments.settings.extras())?;
    let mut analyst = Analyst::new(deployment.clone());
    let mut methods: Vec<Option<Method>> = arguments.method.iter().copied().map(Some).collect();
    if methods.is_empty() {
        methods.push(settings.calibration.method);
    }
    let several = methods.len() > 1;
    let mut objects = Vec::new();
    for method in methods {
        settings.calibration.method = method;
        let analysis = analyst.run(&settings);
        let answer = analysis.answer.clone()?;
        if arguments.json {
            objects.push(json::calibration(&deployment, &analysis, &answer, load_ms));
        } else {
            print(&text::calibration(&deployment, &analysis, &answer))?;
        }
    }
    if let (true, Some(first)) = (arguments.json, objects.first()) {
        let value = if several { Value::Array(objects) } else { first.clone() };
        print(&format!("{value:#}\n"))?;
    }
    Ok(())
}
