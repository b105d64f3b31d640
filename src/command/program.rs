//! The command line: its arguments, and the command that they name.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use super::{
    Failure, ablate, calibrate, check, compare, complain, desktop, evaluate, explain, export, live,
    plan, report, screenshot, simulate, sweep, trajectory, validate, window,
};

/// Inspect a deployment of three robotic total stations, tune its filters, and calibrate it.
#[derive(Parser)]
#[command(version, about, args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// Folders or files to open in the window; the built-in sample if none.
    path: Vec<PathBuf>,
}

#[derive(Subcommand)]
enum Command {
    /// Calibrate a deployment and print the answer
    Calibrate(calibrate::Arguments),
    /// Compare all calibrations that the data allows, by both metrics
    Compare(compare::Arguments),
    /// Tell whether a calibration holds for other runs, and which station moved since
    Validate(validate::Arguments),
    /// Tell what each module of the pipeline brings
    Ablate(ablate::Arguments),
    /// Tell how the errors depend on one threshold
    Sweep(sweep::Arguments),
    /// Write the vehicle's poses in six degrees of freedom
    Trajectory(trajectory::Arguments),
    /// Judge trajectories of other systems by the deployment's own, with its σ
    Evaluate(evaluate::Arguments),
    /// Calibrate while it is driven, from a stream of the network or a replay
    Live(live::Arguments),
    /// Tell what is in a folder or file, and what is wrong with it
    Check(check::Arguments),
    /// Write verdict, transforms, residuals and data as one HTML page
    Report(report::Arguments),
    /// Write a picture of the window
    Screenshot(screenshot::Arguments),
    /// Tell what a drive will leave open before it is driven, and what improves it most
    Plan(plan::Arguments),
    /// Make a deployment with known truth
    Simulate(simulate::Arguments),
    /// Write tracks and residuals for other programs
    Export(export::Arguments),
    /// Explain a word of the field: τ_s, T12, mirror twin
    Explain(explain::Arguments),
    /// Put the program into the menus of a Linux desktop, with its icon and its sessions' file type
    Desktop(desktop::Arguments),
}

/// Runs the program and gives its exit code: 0 for an answer, 1 for bad input, 2 for bad usage.
pub fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) if error.use_stderr() => {
            complain(&one_line(&error.to_string()));
            return ExitCode::from(2);
        }
        // Help and version are answers.
        Err(help) => help.exit(),
    };
    let result = match arguments.command {
        None => window::run(&arguments.path),
        Some(Command::Calibrate(arguments)) => calibrate::run(&arguments),
        Some(Command::Compare(arguments)) => compare::run(&arguments),
        Some(Command::Validate(arguments)) => validate::run(&arguments),
        Some(Command::Ablate(arguments)) => ablate::run(&arguments),
        Some(Command::Sweep(arguments)) => sweep::run(&arguments),
        Some(Command::Trajectory(arguments)) => trajectory::run(&arguments),
        Some(Command::Evaluate(arguments)) => evaluate::run(&arguments),
        Some(Command::Live(arguments)) => live::run(&arguments),
        Some(Command::Check(arguments)) => check::run(&arguments),
        Some(Command::Report(arguments)) => report::run(&arguments),
        Some(Command::Screenshot(arguments)) => screenshot::run(&arguments),
        Some(Command::Plan(arguments)) => plan::run(&arguments),
        Some(Command::Simulate(arguments)) => simulate::run(&arguments),
        Some(Command::Export(arguments)) => export::run(&arguments),
        Some(Command::Explain(arguments)) => explain::run(&arguments),
        Some(Command::Desktop(arguments)) => desktop::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Usage(line)) => {
            complain(&line);
            ExitCode::from(2)
        }
        Err(Failure::Input(error)) => {
            complain(&super::remedy_flags::error_with_flags(&error));
            ExitCode::from(1)
        }
    }
}

/// What clap says, up to its usage, as one line.
fn one_line(message: &str) -> String {
    let said: Vec<_> = message
        .lines()
        .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more information"))
        .map(str::trim)
        .filter(|line| !line.is_empty())
        .collect();
    format!("{}; see --help", said.join(" ").trim_start_matches("error: "))
}
