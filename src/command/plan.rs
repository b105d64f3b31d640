//! `resect plan`: the expected accuracy of a drive before it is driven, and improvements of it.

use std::path::{Path, PathBuf};

use clap::Args;

use super::choice::{PRESETS, choice};
use super::output::{is_standard_output, spare, write};
use super::settings_args::AnswerArguments;
use super::{Failure, load, print};
use resect_core::analysis::Analyst;
use resect_core::progress::Progress;
use resect_io::file_mark::used_files;
use resect_io::{plan_file, way_file};
use resect_report::planning;
use resect_tools::planning::{Plan, improvements, predict};
use resect_tools::simulation::Preset;

#[derive(Args)]
pub struct PlanArguments {
    /// A plan (TOML), or a folder or file of a past deployment, whose stations, rig and path become one
    #[arg(required_unless_present = "preset")]
    path: Option<PathBuf>,
    /// Take stations, rig and path from a preset of `simulate`, instead of a file
    #[arg(long, value_parser = choice(PRESETS), conflicts_with = "path")]
    preset: Option<Preset>,
    /// Seed of the preset's drive
    #[arg(long, default_value_t = 1, conflicts_with = "path")]
    seed: u64,
    /// File with the path to drive, instead of the plan's: CSV (x, y), PLY or GeoJSON (with the stations as points)
    #[arg(long, value_name = "FILE")]
    way: Option<PathBuf>,
    /// Largest acceptable root mean square error at the far end (mm), instead of the plan's
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    target: Option<f64>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Write the plan as TOML, to edit it and plan again; - for standard output instead of the prediction
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    settings: AnswerArguments,
}

pub fn run(arguments: &PlanArguments) -> Result<(), Failure> {
    let (mut plan, read) = plan(arguments)?;
    if let Some(target_mm) = arguments.target {
        plan.target_mm = target_mm;
        plan.check().map_err(|(what, remedy)| Failure::Usage(format!("{what}; {remedy}")))?;
    }
    if let Some(way) = &arguments.way {
        way_file::read(way)?.lay(&mut plan);
        let senseless = |(what, remedy)| anyhow::anyhow!("{}: {what}; {remedy}", way.display());
        plan.check().map_err(senseless)?;
    }
    if let Some(out) = &arguments.out {
        let read = read.iter().chain(&arguments.way).map(|path| &**path);
        spare(out, read)?;
    }
    let found = predict(&plan)?;
    let better = improvements(&plan, &Progress::default())?;
    if let Some(out) = &arguments.out {
        write(out, plan_file::text(&plan))?;
    }
    if arguments.out.as_deref().is_some_and(is_standard_output) {
        return Ok(());
    }
    if arguments.json {
        print(&format!("{:#}\n", planning::json(&plan, &found, &better)))?;
    } else {
        print(&planning::text(&plan, &found, &better))?;
    }
    Ok(())
}

/// Returns the plan, and the files that it was read from.
fn plan(arguments: &PlanArguments) -> Result<(Plan, Vec<PathBuf>), Failure> {
    if let Some(preset) = arguments.preset {
        return Ok((Plan::from_preset(preset, arguments.seed), Vec::new()));
    }
    let path = arguments.path.as_deref().unwrap_or(Path::new("."));
    if path.is_file() && path.extension().is_some_and(|ending| ending == "toml") {
        return Ok((plan_file::read(path)?, vec![path.to_owned()]));
    }
    let settings = arguments.settings.settings()?;
    let (deployment, _) = load(path, arguments.settings.extras())?;
    let analysis = Analyst::new(deployment.clone()).run(&settings);
    let plan = Plan::from_analysis(&deployment, &analysis)?;
    Ok((plan, used_files(&deployment).map(Path::to_owned).collect()))
}
