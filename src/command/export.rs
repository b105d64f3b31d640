//! `resect export`: tracks and residuals for other programs.

use std::path::PathBuf;

use clap::Args;

use super::output::spare_file;
use super::settings_args::AnswerArguments;
use super::{Failure, load, note, print};
use resect_core::analysis::Analyst;
use resect_io::file_mark::used_files;
use resect_report::arrow;
use resect_report::csv::TABLES;

#[derive(Args)]
#[command(group(clap::ArgGroup::new("target").required(true).args(["rrd", "csv", "arrow"]).multiple(true)))]
pub struct ExportArguments {
    /// Folder or file with the stations' tracks
    path: PathBuf,
    /// Recording for the Rerun viewer
    #[arg(long, value_name = "FILE")]
    rrd: Option<PathBuf>,
    /// Folder for readings.csv, triplets.csv, residuals.csv, transforms.csv, clocks.csv and answer.csv
    #[arg(long, value_name = "DIR")]
    csv: Option<PathBuf>,
    /// Folder for the same tables as Arrow files (Feather) for pandas, polars and DuckDB
    #[arg(long, value_name = "DIR")]
    arrow: Option<PathBuf>,
    #[command(flatten)]
    settings: AnswerArguments,
}

pub fn run(arguments: &ExportArguments) -> Result<(), Failure> {
    let settings = arguments.settings.settings()?;
    let (deployment, _) = load(&arguments.path, arguments.settings.extras())?;
    for folder in arguments.csv.iter().chain(&arguments.arrow) {
        spare_file(folder, [])?;
    }
    let tables = arguments.csv.iter().flat_map(|folder| TABLES.map(|name| folder.join(name)));
    let arrow = arguments.arrow.iter();
    let arrow = arrow.flat_map(|folder| TABLES.map(|name| folder.join(arrow::file_of(name))));
    for file in tables.chain(arrow).chain(arguments.rrd.clone()) {
        spare_file(&file, used_files(&deployment))?;
    }
    let analysis = Analyst::new(deployment.clone()).run(&settings);
    if let Err(error) = &analysis.answer {
        note(&format!("no answer, so stations are drawn in their own frames: {error}"));
    }
    if let Some(folder) = &arguments.csv {
        for file in resect_report::csv::write_folder(&deployment, &analysis, folder)? {
            print(&format!("{}\n", file.display()))?;
        }
    }
    if let Some(folder) = &arguments.arrow {
        for file in arrow::write_folder(&deployment, &analysis, folder)? {
            print(&format!("{}\n", file.display()))?;
        }
    }
    if let Some(file) = &arguments.rrd {
        resect_report::rerun::save(&deployment, &analysis, file)?;
        print(&format!("{}: open it with `rerun {}`\n", file.display(), file.display()))?;
    }
    Ok(())
}
