//! Plain `resect`: the window, or without a display the calibration in the terminal.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::frame_times::numbered_poses;
use super::remedy_flags::finding_line;
use super::{Failure, complain, load, note, print};
use crate::app;
use crate::app::persist::{hashes::HashCache, session_file};
use resect_core::analysis::{Analysis, Analyst, Settings};
use resect_core::deployment::Deployment;
use resect_core::progress::Progress;
use resect_io::estimate_file;
use resect_io::evaluation_files::EvaluationFiles;
use resect_io::sample::Sample;
use resect_io::source::{Extras, Source};
use resect_io::what_is::{Dropped, what_is};
use resect_report::{estimates, text};
use resect_tools::estimates::{EstimatedTrajectory, GroundTruth, Options, TruthReason, judge};

pub fn run(paths: &[PathBuf]) -> Result<(), Failure> {
    #[cfg(windows)]
    super::console::leave_own();
    // The window opens sessions, since it can skip missing files.
    if let [path] = paths
        && what_is(path) == Dropped::Session
    {
        return match window(app::Start::Session(path.clone())) {
            Ok(()) => Ok(()),
            Err(why) => in_terminal(&of_session(path)?, &[], &why, ""),
        };
    }
    if paths.is_empty() {
        return match window(app::Start::Sample(Sample::Warthog)) {
            Ok(()) => Ok(()),
            Err(why) => {
                let sample = (Arc::new(Sample::Warthog.open()?), Settings::default());
                in_terminal(&[sample], &[], &why, "; this is the built-in sample")
            }
        };
    }
    let is_alone = paths.len() == 1 && std::io::stderr().is_terminal();
    let mut opened = OpenedPaths::default();
    for path in paths {
        // A single path that does not open ends the program with an error on the terminal; of several, the window shows the others.
        // Without a terminal, as from a menu, only the window can show the reason.
        if let Err(error) = opened.open(path) {
            if is_alone || !has_display() {
                return Err(error.into());
            }
            complain(&format!("{error:#}"));
            opened.why_not.push(format!("{error:#}"));
        }
    }
    let OpenedPaths { deployments, trajectories, why_not } = opened;
    if deployments.is_empty()
        && let Some(files) = EvaluationFiles::of(trajectories.clone())?
    {
        return match window(app::Start::Evaluation(Box::new(files.clone()), why_not)) {
            Ok(()) => Ok(()),
            Err(why) => {
                print(&format!("{why}\n\n{}", evaluation(files)))?;
                print_next_steps()
            }
        };
    }
    let read =
        deployments.iter().map(|(deployment, _)| (Arc::clone(deployment), Settings::default()));
    let read: Vec<_> = read.collect();
    let estimates = trajectories.iter().cloned();
    let estimates = estimates.map(|one| (Arc::new(one), Options::default())).collect();
    match window(app::Start::Partly { deployments, estimates, why_not }) {
        Ok(()) => Ok(()),
        Err(why) => in_terminal(&read, &trajectories, &why, ""),
    }
}

/// Content of the paths of the command line.
#[derive(Default)]
struct OpenedPaths {
    deployments: Vec<(Arc<Deployment>, Source)>,
    trajectories: Vec<EstimatedTrajectory>,
    /// Reasons of the paths that could not be opened.
    why_not: Vec<String>,
}

impl OpenedPaths {
    /// Reads a deployment, or trajectories of another system. A file of GNSS alone is a trajectory.
    fn open(&mut self, path: &Path) -> anyhow::Result<()> {
        if let Some(read) = numbered_poses(path) {
            self.trajectories.push(read?);
            return Ok(());
        }
        if matches!(what_is(path), Dropped::Estimate | Dropped::Gnss) {
            self.trajectories.extend(estimate_file::read(path)?);
            return Ok(());
        }
        match load(path, Extras::default()) {
            Ok((deployment, _)) => {
                self.deployments.push((deployment, Source::at(std::path::absolute(path)?)));
            }
            // A bag has tracks, or the poses of another system.
            Err(error) => match estimate_file::read(path) {
                Ok(trajectories) => self.trajectories.extend(trajectories),
                Err(_) => return Err(error.into()),
            },
        }
        Ok(())
    }
}

/// Formats the evaluation of trajectories against the one that is the ground truth.
fn evaluation(EvaluationFiles { truth, estimates, reason, .. }: EvaluationFiles) -> String {
    let name = &truth.name;
    if reason == TruthReason::Alone {
        let trajectory = truth.ground_truth.as_deref();
        let facts = trajectory.map(estimates::trajectory_in_words).unwrap_or_default();
        return format!("{name} · {facts}\n{}\n", estimates::ADD_A_TRUTH);
    }
    let analysis = Analyst::new(Arc::clone(&truth)).run(&Settings::default());
    format!(
        "ground truth: {name} ({}); another one: resect evaluate … --against TRUTH\n\n{}",
        reason.in_words(),
        evaluated(&truth, &analysis, &estimates)
    )
}

fn evaluated(
    deployment: &Deployment,
    analysis: &Analysis,
    estimates: &[EstimatedTrajectory],
) -> String {
    let truth = GroundTruth::of(deployment, analysis, None);
    let estimates = estimates.iter().map(|one| (one.clone(), Options::default()));
    estimates::text(&truth, &judge(&truth, estimates.collect()))
}

/// Runs the window until it closes; fails with the reason if it cannot open.
fn window(start: app::Start) -> Result<(), String> {
    if !has_display() {
        return Err("no display".to_owned());
    }
    let opened = app::open_window(start).map_err(|error| match error {
        eframe::Error::Wgpu(error) => app::without_graphics(&error),
        eframe::Error::Winit(error) => format!("the window did not open ({})", reason(&error)),
        eframe::Error::WinitEventLoop(error) => {
            format!("the window did not open ({})", reason(&error))
        }
        other => format!("the window did not open ({other})"),
    });
    #[cfg(windows)]
    if let Err(why) = &opened {
        super::console::show(why);
    }
    opened
}

/// Message of the window's library without the place in its source.
fn reason(error: &impl std::fmt::Display) -> String {
    let text = error.to_string();
    let after_place = text.rsplit_once(".rs:").and_then(|(_, rest)| rest.split_once(": "));
    after_place.map_or(text.as_str(), |(_, reason)| reason).to_owned()
}

/// Returns true if there is a display; systems other than Linux always have one.
fn has_display() -> bool {
    !cfg!(target_os = "linux")
        || ["WAYLAND_DISPLAY", "DISPLAY"]
            .iter()
            .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
}

/// Returns the deployments of a session, each with its settings.
fn of_session(path: &Path) -> Result<Vec<(Arc<Deployment>, Settings)>, Failure> {
    let (session, findings) = session_file::load(path)?;
    for finding in findings {
        note(&format!("{}: {finding}", path.display()));
    }
    if session.deployments.is_empty() {
        return Err(Failure::Input(anyhow::anyhow!(
            "{}: a session without deployments, which only the window can show; run resect with a display",
            path.display()
        )));
    }
    let (cache, progress) = (HashCache::default(), Progress::default());
    let open = session
        .deployments
        .into_iter()
        .map(|saved| Ok::<_, Failure>((Arc::new(saved.open(&cache, &progress)?), saved.settings)));
    open.collect()
}

/// Prints the calibrations without a window, with the evaluation of trajectories against the last one, and names the alternatives.
fn in_terminal(
    deployments: &[(Arc<Deployment>, Settings)],
    trajectories: &[EstimatedTrajectory],
    why: &str,
    what: &str,
) -> Result<(), Failure> {
    print(&format!("{why}{what}\n\n"))?;
    for (index, (deployment, settings)) in deployments.iter().enumerate() {
        let analysis = Analyst::new(Arc::clone(deployment)).run(settings);
        let answer = analysis.answer.clone()?;
        print(&text::calibration(deployment, &analysis, &answer, finding_line))?;
        print(&text::durations(&analysis, &answer))?;
        if index + 1 == deployments.len() && !trajectories.is_empty() {
            print(&format!("\n{}", evaluated(deployment, &analysis, trajectories)))?;
        }
    }
    print_next_steps()
}

fn print_next_steps() -> Result<(), Failure> {
    let window = if cfg!(target_os = "linux") {
        "where there is a display (over ssh: ssh -X, or xvfb-run)"
    } else {
        "on a desktop with a graphics driver"
    };
    Ok(print(&format!(
        "\nwindow      run resect {window}\n\
         picture     resect screenshot [PATH] --out window.png\n\
         your data   resect calibrate PATH [--json]\n"
    ))?)
}
