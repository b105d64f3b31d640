//! `resect completions`: completion scripts for shells.

use clap::{Args, Command};
use clap_complete::Shell;

use super::Failure;

#[derive(Args)]
pub struct CompletionsArguments {
    /// Shell for which the script is written
    shell: Shell,
}

pub fn run(arguments: &CompletionsArguments, mut program: Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut program, "resect", &mut script);
    super::printing::print_bytes(&script)?;
    Ok(())
}
