//! Arguments that the commands for studies share: deployments, splits, output.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;

use super::settings_args::SettingsArguments;
use super::{Failure, load_each, print};
use resect_core::deployment::Deployment;
use resect_report::study;
use resect_tools::experiment::{Splits, Study};

#[derive(Args)]
pub struct StudyArguments {
    /// Folders or files with the stations' tracks
    #[arg(required = true)]
    path: Vec<PathBuf>,
    /// Folder for the plot (SVG, PNG) and the table (CSV)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
    /// Number of random splits: 75 % of the data to solve, the rest to evaluate
    #[arg(long, value_name = "REPEATS")]
    splits: Option<usize>,
    /// Seed of the random splits
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    pub settings: SettingsArguments,
}

impl StudyArguments {
    pub fn deployments(&self) -> Result<Vec<Arc<Deployment>>, Failure> {
        load_each(&self.path, &self.settings.extras())
            .into_iter()
            .map(|opened| Ok(opened?))
            .collect()
    }

    pub fn splits(&self) -> Result<Option<Splits>, Failure> {
        match self.splits {
            Some(0) => Err(Failure::Usage("--splits must be at least 1".to_owned())),
            Some(repeats) if repeats > 1000 => {
                Err(Failure::Usage("--splits must be at most 1000".to_owned()))
            }
            repeats => Ok(repeats.map(|repeats| Splits { repeats, seed: self.seed })),
        }
    }

    /// Writes the files and, without `--json`, prints their names.
    pub fn write(&self, study: &Study) -> Result<(), Failure> {
        let Some(folder) = &self.out else { return Ok(()) };
        let written = study::write(study, folder)?;
        if !self.json {
            for path in written {
                print(&format!("{}\n", path.display()))?;
            }
        }
        Ok(())
    }
}
