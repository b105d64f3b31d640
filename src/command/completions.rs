//! `resect completions`: completion scripts for shells.

use clap::Args;
use clap_complete::Shell;

use super::Failure;
use super::program::arguments;

#[derive(Args)]
pub struct CompletionsArguments {
    /// Shell for which the script is written
    shell: Shell,
}

pub fn run(arguments_of_user: &CompletionsArguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments_of_user.shell, &mut arguments(), "resect", &mut script);
    super::printing::print_bytes(&script)?;
    Ok(())
}
