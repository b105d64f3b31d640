//! Plain `resect`: the window, or without a display the answer in the terminal.

use std::path::PathBuf;
use std::sync::Arc;

use super::{Failure, load, print};
use crate::analysis::{Analyst, Settings};
use crate::app;
use crate::deployment::{Deployment, Dropped, Extras, Sample, Source, what_is};
use crate::export::text;

pub fn run(paths: &[PathBuf]) -> Result<(), Failure> {
    let has_display = has_display();
    // A session is opened by the window, which can leave out what is missing.
    if let [path] = paths
        && has_display
        && what_is(path) == Dropped::Session
    {
        let opened = app::open_window(app::Start::Session(path.clone()));
        return opened.map_err(|error| anyhow::anyhow!("the window did not open ({error})").into());
    }
    // A path that does not open ends here, on the terminal it came from.
    let deployments = paths
        .iter()
        .map(|path| Ok((load(path, Extras::default())?.0, Source::at(std::path::absolute(path)?))))
        .collect::<Result<Vec<(Arc<Deployment>, Source)>, Failure>>()?;
    if !has_display {
        return without_display(deployments, "no display");
    }
    let start = if deployments.is_empty() {
        app::Start::Sample(Sample::Warthog)
    } else {
        app::Start::Deployments(deployments.clone())
    };
    match app::open_window(start) {
        Ok(()) => Ok(()),
        Err(error) => without_display(deployments, &format!("the window did not open ({error})")),
    }
}

/// Other systems always have one.
fn has_display() -> bool {
    !cfg!(target_os = "linux")
        || ["WAYLAND_DISPLAY", "DISPLAY"]
            .iter()
            .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
}

fn without_display(
    mut deployments: Vec<(Arc<Deployment>, Source)>,
    why: &str,
) -> Result<(), Failure> {
    let mut what = "";
    if deployments.is_empty() {
        what = "; this is the built-in sample";
        let sample = Arc::new(Sample::Warthog.open()?);
        deployments.push((sample, Source::sample(Sample::Warthog)));
    }
    print(&format!("{why}{what}\n\n"))?;
    for (deployment, _) in deployments {
        let analysis = Analyst::new(deployment.clone()).run(&Settings::default());
        let answer = analysis.answer.clone()?;
        print(&text::calibration(&deployment, &analysis, &answer))?;
        print(&text::durations(&analysis, &answer))?;
    }
    print(
        "\nwindow      run resect where there is a display (over ssh: ssh -X, or xvfb-run)\n\
         picture     resect screenshot [PATH] --out window.png\n\
         your data   resect calibrate PATH [--json]\n",
    )?;
    Ok(())
}
