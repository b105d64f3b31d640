//! The command line: its arguments and subcommands.

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
    command: Option<CliCommand>,
    /// Folders or files to open in the window; the built-in sample if none.
    path: Vec<PathBuf>,
}

#[derive(Subcommand)]
enum CliCommand {
    /// Calibrate a deployment and print the result
    Calibrate(calibrate::CalibrateArguments),
    /// Compare all calibrations that the data allows, by both metrics
    Compare(compare::CompareArguments),
    /// Test if a calibration still fits other runs, and which station moved since
    Validate(validate::ValidateArguments),
    /// Measure the contribution of each module of the pipeline
    Ablate(ablate::AblateArguments),
    /// Measure how the errors depend on one threshold
    Sweep(sweep::SweepArguments),
    /// Write the vehicle's poses in six degrees of freedom
    Trajectory(trajectory::TrajectoryArguments),
    /// Evaluate trajectories of other systems against the ground truth of a deployment, with its σ
    Evaluate(evaluate::EvaluateArguments),
    /// Calibrate during the drive, from a stream of the network or a replay
    Live(live::LiveArguments),
    /// Describe a folder or file, and report its faults
    Check(check::CheckArguments),
    /// Write verdict, transforms, residuals and data as one HTML page
    Report(report::ReportArguments),
    /// Write an image of the window
    Screenshot(screenshot::ScreenshotArguments),
    /// Predict the covariance of a drive before it is driven, and the best improvement
    Plan(plan::PlanArguments),
    /// Simulate a deployment with known ground truth
    Simulate(simulate::SimulateArguments),
    /// Write tracks and residuals for other programs
    Export(export::ExportArguments),
    /// Explain a technical term: τ_s, T12, mirror ambiguity
    Explain(explain::ExplainArguments),
    /// Add the program, its icon and its file type to the menus of a Linux desktop
    Desktop(desktop::DesktopArguments),
}

/// Runs the program and returns its exit code: 0 for success, 1 for bad input, 2 for bad usage.
pub fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) if error.use_stderr() => {
            complain(&one_line(&error.to_string()));
            return ExitCode::from(2);
        }
        // Help and version are no errors.
        Err(help) => help.exit(),
    };
    let result = match arguments.command {
        None => window::run(&arguments.path),
        Some(CliCommand::Calibrate(arguments)) => calibrate::run(&arguments),
        Some(CliCommand::Compare(arguments)) => compare::run(&arguments),
        Some(CliCommand::Validate(arguments)) => validate::run(&arguments),
        Some(CliCommand::Ablate(arguments)) => ablate::run(&arguments),
        Some(CliCommand::Sweep(arguments)) => sweep::run(&arguments),
        Some(CliCommand::Trajectory(arguments)) => trajectory::run(&arguments),
        Some(CliCommand::Evaluate(arguments)) => evaluate::run(&arguments),
        Some(CliCommand::Live(arguments)) => live::run(&arguments),
        Some(CliCommand::Check(arguments)) => check::run(&arguments),
        Some(CliCommand::Report(arguments)) => report::run(&arguments),
        Some(CliCommand::Screenshot(arguments)) => screenshot::run(&arguments),
        Some(CliCommand::Plan(arguments)) => plan::run(&arguments),
        Some(CliCommand::Simulate(arguments)) => simulate::run(&arguments),
        Some(CliCommand::Export(arguments)) => export::run(&arguments),
        Some(CliCommand::Explain(arguments)) => explain::run(&arguments),
        Some(CliCommand::Desktop(arguments)) => desktop::run(&arguments),
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

/// Returns clap's message, up to its usage, as one line.
fn one_line(message: &str) -> String {
    let said: Vec<_> = message
        .lines()
        .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more information"))
        .map(str::trim)
        .filter(|line| !line.is_empty())
        .collect();
    format!("{}; see --help", said.join(" ").trim_start_matches("error: "))
}
