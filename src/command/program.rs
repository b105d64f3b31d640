//! The command line: its arguments and subcommands.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use super::progress_line::be_quiet;
use super::{
    Failure, ablate, calibrate, check, compare, complain, completions, desktop, evaluate, explain,
    export, extrinsics, licences, live, plan, report, schema, screenshot, simulate, sweep,
    trajectory, validate, window,
};

/// Version with the commit and the features that the program was built from.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("RESECT_BUILD"), ")");
const AFTER_HELP: &str = "\
Examples:
  resect FOLDER                       open a deployment in the window
  resect calibrate FOLDER --json      calibrate it in a script

Exit codes: 0 for an answer, 1 for bad input, 2 for wrong usage.
Results are printed on standard output, without colours; errors, notes and progress on standard error.";

/// Inspect a deployment of robotic total stations, tune its filters, and calibrate it.
#[derive(Parser)]
#[command(
    version = VERSION, about, subcommand_precedence_over_arg = true, max_term_width = 100,
    after_help = AFTER_HELP,
    override_usage = "resect [OPTIONS] [PATH]...\n       resect [OPTIONS] <COMMAND>"
)]
struct Arguments {
    #[command(subcommand)]
    command: Option<CliCommand>,
    /// Print no progress and no notes; errors are still printed
    #[arg(long, global = true)]
    quiet: bool,
    /// Folders or files to open in the window; the built-in sample if none. Trajectories are evaluated against a deployment among them, or
    /// against the one that is the ground truth.
    path: Vec<PathBuf>,
}

#[derive(Subcommand)]
enum CliCommand {
    /// Calibrate a deployment and print the result
    #[command(after_help = "Example: resect calibrate FOLDER --json > calibration.json")]
    Calibrate(calibrate::CalibrateArguments),
    /// Compare all calibrations that the data allows, by both metrics
    #[command(after_help = "Example: resect compare FOLDER --out figures")]
    Compare(compare::CompareArguments),
    /// Test if a calibration still fits other runs, and which station moved since
    #[command(after_help = "Example: resect validate calibration.json OTHER_FOLDER")]
    Validate(validate::ValidateArguments),
    /// Measure the contribution of each module of the pipeline
    #[command(after_help = "Example: resect ablate FOLDER --splits 20 --out figures")]
    Ablate(ablate::AblateArguments),
    /// Measure how the errors depend on one threshold
    #[command(after_help = "Example: resect sweep FOLDER --parameter tau-s --from 0.5 --to 3")]
    Sweep(sweep::SweepArguments),
    /// Write the vehicle's poses in six degrees of freedom
    #[command(after_help = "Example: resect trajectory FOLDER --pose-rate 50 --out drive.tum")]
    Trajectory(trajectory::TrajectoryArguments),
    /// Evaluate trajectories of other systems against the ground truth of a deployment, with its σ
    #[command(after_help = "Example: resect evaluate slam.tum odometry.tum --against FOLDER")]
    Evaluate(evaluate::EvaluateArguments),
    /// Estimate the pose of a body or an antenna in another body from their trajectories
    #[command(after_help = "Example: resect extrinsics lidar.tum antenna.pos --copy urdf")]
    Extrinsics(extrinsics::ExtrinsicsArguments),
    /// Calibrate during the drive, from a stream of the network or a replay
    #[command(after_help = "Example: resect live ws://robot:8765 --rig FOLDER --record drive.mcap")]
    Live(live::LiveArguments),
    /// Describe a folder or file, and report its faults
    #[command(after_help = "Example: resect check FOLDER")]
    Check(check::CheckArguments),
    /// Write verdict, transforms, residuals and data as one HTML page
    #[command(after_help = "Example: resect report FOLDER --out report.html")]
    Report(report::ReportArguments),
    /// Write an image of the window
    #[command(
        after_help = "Example: resect screenshot FOLDER --pane residuals --scale 2 --out residuals.png"
    )]
    Screenshot(screenshot::ScreenshotArguments),
    /// Predict the covariance of a drive before it is driven, and the best improvement
    #[command(after_help = "Example: resect plan plan.toml")]
    Plan(plan::PlanArguments),
    /// Simulate a deployment with known ground truth
    #[command(after_help = "Example: resect simulate --preset warthog --seed 1 --out simulated")]
    Simulate(simulate::SimulateArguments),
    /// Write tracks and residuals for other programs
    #[command(after_help = "Example: resect export FOLDER --csv tables")]
    Export(export::ExportArguments),
    /// Write the JSON Schema of the JSON outputs
    #[command(after_help = "Example: resect schema calibrate > calibrate.schema.json")]
    Schema(schema::SchemaArguments),
    /// Explain a technical term: τ_s, T12, mirror ambiguity
    #[command(after_help = "Example: resect explain tau-s")]
    Explain(explain::ExplainArguments),
    /// Add the program, its icon and its file type to the menus of Linux or Windows
    #[command(after_help = "Example: resect desktop")]
    Desktop(desktop::DesktopArguments),
    /// Write the completion script of a shell
    #[command(
        after_help = "Example: resect completions bash > ~/.local/share/bash-completion/completions/resect"
    )]
    Completions(completions::CompletionsArguments),
    /// Print the licences of the program and of the packages in it
    #[command(after_help = "Example: resect licences | less")]
    Licences,
}

/// Returns the description of the command line, for completions and manual pages.
pub fn arguments() -> clap::Command {
    Arguments::command()
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
    if arguments.quiet {
        be_quiet();
    }
    if arguments.command.is_some()
        && let Some(path) = arguments.path.first()
    {
        complain(&format!("{}: paths follow the command; see --help", path.display()));
        return ExitCode::from(2);
    }
    let result = match arguments.command {
        None => window::run(&arguments.path),
        Some(CliCommand::Calibrate(arguments)) => calibrate::run(&arguments),
        Some(CliCommand::Compare(arguments)) => compare::run(&arguments),
        Some(CliCommand::Validate(arguments)) => validate::run(&arguments),
        Some(CliCommand::Ablate(arguments)) => ablate::run(&arguments),
        Some(CliCommand::Sweep(arguments)) => sweep::run(&arguments),
        Some(CliCommand::Trajectory(arguments)) => trajectory::run(&arguments),
        Some(CliCommand::Evaluate(arguments)) => evaluate::run(&arguments),
        Some(CliCommand::Extrinsics(arguments)) => extrinsics::run(&arguments),
        Some(CliCommand::Live(arguments)) => live::run(&arguments),
        Some(CliCommand::Check(arguments)) => check::run(&arguments),
        Some(CliCommand::Report(arguments)) => report::run(&arguments),
        Some(CliCommand::Screenshot(arguments)) => screenshot::run(&arguments),
        Some(CliCommand::Plan(arguments)) => plan::run(&arguments),
        Some(CliCommand::Simulate(arguments)) => simulate::run(&arguments),
        Some(CliCommand::Export(arguments)) => export::run(&arguments),
        Some(CliCommand::Schema(arguments)) => schema::run(&arguments),
        Some(CliCommand::Explain(arguments)) => explain::run(&arguments),
        Some(CliCommand::Desktop(arguments)) => desktop::run(&arguments),
        Some(CliCommand::Completions(arguments)) => {
            completions::run(&arguments, Arguments::command())
        }
        Some(CliCommand::Licences) => licences::run(),
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
