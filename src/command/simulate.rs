//! `resect simulate`: a deployment with known truth, as files.

use std::path::PathBuf;

use clap::Args;

use super::{Failure, print};
use crate::simulation::{Preset, simulate, write_folder};

#[derive(Args)]
pub struct Arguments {
    /// What is driven, and where
    #[arg(long, value_enum)]
    preset: Preset,
    /// The same seed gives the same files
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder to write into
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let simulated = simulate(arguments.preset, arguments.seed);
    write_folder(&simulated, &arguments.out)?;
    print(&format!(
        "{}: {} readings ({} outliers, {} lost), {} control-point sets; the truth is in truth.toml\n\
         next: resect calibrate {}\n",
        arguments.out.display(),
        simulated.records.len(),
        simulated.truth.outliers,
        simulated.truth.lost_readings,
        simulated.control_points.len(),
        arguments.out.display(),
    ))?;
    Ok(())
}
