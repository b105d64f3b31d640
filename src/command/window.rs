//! Plain `resect`: the window, or without a display the calibration in the terminal.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::remedy_flags::finding_line;
use super::{Failure, complain, load, note, print};
use crate::app;
use crate::app::persist::{hashes::HashCache, session_file};
use resect_core::analysis::{Analyst, Settings};
use resect_core::deployment::Deployment;
use resect_core::progress::Progress;
use resect_io::sample::Sample;
use resect_io::source::{Extras, Source};
use resect_io::what_is::{Dropped, what_is};
use resect_report::text;

pub fn run(paths: &[PathBuf]) -> Result<(), Failure> {
    #[cfg(windows)]
    super::console::leave_own();
    // The window opens sessions, since it can skip missing files.
    if let [path] = paths
        && what_is(path) == Dropped::Session
    {
        return match window(app::Start::Session(path.clone())) {
            Ok(()) => Ok(()),
            Err(why) => in_terminal(&of_session(path)?, &why, ""),
        };
    }
    if paths.is_empty() {
        return match window(app::Start::Sample(Sample::Warthog)) {
            Ok(()) => Ok(()),
            Err(why) => {
                let sample = (Arc::new(Sample::Warthog.open()?), Settings::default());
                in_terminal(&[sample], &why, "; this is the built-in sample")
            }
        };
    }
    let (mut deployments, mut why_not) = (Vec::new(), Vec::new());
    for path in paths {
        match opened(path) {
            Ok(deployment) => deployments.push(deployment),
            // A single path that does not open ends the program with an error on the terminal; of several, the window shows the others.
            // Without a terminal, as from a menu, only the window can show the reason.
            Err(error) => {
                let is_alone = paths.len() == 1 && std::io::stderr().is_terminal();
                if is_alone || !has_display() {
                    return Err(error.into());
                }
                complain(&format!("{error:#}"));
                why_not.push(format!("{error:#}"));
            }
        }
    }
    let read =
        deployments.iter().map(|(deployment, _)| (Arc::clone(deployment), Settings::default()));
    let read: Vec<_> = read.collect();
    match window(app::Start::Partly(deployments, why_not)) {
        Ok(()) => Ok(()),
        Err(why) => in_terminal(&read, &why, ""),
    }
}

fn opened(path: &Path) -> anyhow::Result<(Arc<Deployment>, Source)> {
    Ok((load(path, Extras::default())?.0, Source::at(std::path::absolute(path)?)))
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

/// Prints the calibrations without a window, and names the alternatives.
fn in_terminal(
    deployments: &[(Arc<Deployment>, Settings)],
    why: &str,
    what: &str,
) -> Result<(), Failure> {
    print(&format!("{why}{what}\n\n"))?;
    for (deployment, settings) in deployments {
        let analysis = Analyst::new(Arc::clone(deployment)).run(settings);
        let answer = analysis.answer.clone()?;
        print(&text::calibration(deployment, &analysis, &answer, finding_line))?;
        print(&text::durations(&analysis, &answer))?;
    }
    let window = if cfg!(target_os = "linux") {
        "where there is a display (over ssh: ssh -X, or xvfb-run)"
    } else {
        "on a desktop with a graphics driver"
    };
    print(&format!(
        "\nwindow      run resect {window}\n\
         picture     resect screenshot [PATH] --out window.png\n\
         your data   resect calibrate PATH [--json]\n"
    ))?;
    Ok(())
}
