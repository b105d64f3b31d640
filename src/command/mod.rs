//! The command line: one file a subcommand. Nothing below this module prints.

mod ablate;
mod calibrate;
mod check;
mod choice;
mod compare;
mod desktop;
mod evaluate;
mod explain;
mod export;
mod judging_args;
mod live;
mod output;
mod plan;
mod remedy_flags;
mod report;
mod screenshot;
mod settings_args;
mod simulate;
mod study_args;
mod sweep;
mod trajectory;
mod validate;
mod window;

use std::io::Write;
use std::iter::zip;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use clap::{Parser, Subcommand};

use resect_core::deployment::Deployment;
use resect_core::deployment::names::told_apart;
use resect_core::deployment::printable::printable;
use resect_core::progress::Progress;
use resect_io::atomic::WriteError;
use resect_io::error::OpenError;
use resect_io::source::{Extras, Source};

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

/// Why a command ends without an answer.
#[derive(Debug)]
enum Failure {
    /// The user's words are off: exit code 2.
    Usage(String),
    /// The input is: exit code 1.
    Input(anyhow::Error),
}

impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Input(error.into())
    }
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
            complain(&remedy_flags::error_with_flags(&error));
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

/// Says what is wrong, in one line whatever the names in it hold.
fn complain(line: &str) {
    // Nobody may be there to read it; the exit code says so much as well.
    _ = writeln!(std::io::stderr(), "resect: {}", printable(line));
}

/// Prints, and ends quietly when the reader has gone (`resect … | head`).
fn print(text: &str) -> Result<(), WriteError> {
    let mut out = std::io::stdout();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(WriteError::of_file(Path::new("standard output"), error))
        }
        _ => Ok(()),
    }
}

/// A deployment and how long opening it took (ms).
fn load(path: &Path, extras: Extras) -> Result<(Arc<Deployment>, f64), OpenError> {
    let started = Instant::now();
    let deployment = Source::at(path).with(extras).open(&Progress::default())?;
    Ok((Arc::new(deployment), started.elapsed().as_secs_f64() * 1e3))
}

/// Opens several deployments, and gives those of one name longer ones that tell them apart.
fn load_each(paths: &[PathBuf], extras: &Extras) -> Vec<Result<Arc<Deployment>, OpenError>> {
    let mut loaded: Vec<Result<Arc<Deployment>, OpenError>> =
        paths.iter().map(|path| Ok(load(path, extras.clone())?.0)).collect();
    let places: Vec<PathBuf> = paths
        .iter()
        .map(|path| std::path::absolute(path).unwrap_or_else(|_| path.clone()))
        .collect();
    let named: Vec<(String, Option<&Path>)> = zip(&loaded, &places)
        .filter_map(|(opened, place)| Some((opened.as_ref().ok()?.name.clone(), Some(&**place))))
        .collect();
    for (deployment, name) in zip(loaded.iter_mut().flatten(), told_apart(&named)) {
        Arc::make_mut(deployment).name = name;
    }
    loaded
}
