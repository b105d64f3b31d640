//! Plain `resect`: the window, or without a display the answer in the terminal.

use std::path::Path;
use std::sync::Arc;

use super::{Failure, load, print};
use crate::analysis::{Analyst, Settings};
use crate::app;
use crate::deployment::Sample;
use crate::export::text;

pub fn run(path: Option<&Path>) -> Result<(), Failure> {
    if !has_display() {
        return without_display(path, "no display");
    }
    // A path that does not open ends here, on the terminal it came from.
    let start = match path {
        Some(path) => app::Start::Deployment(load(path, None)?.0),
        None => app::Start::Sample(Sample::Warthog),
    };
    match app::open_window(start) {
        Ok(()) => Ok(()),
        Err(error) => without_display(path, &format!("the window did not open ({error})")),
    }
}

/// Other systems always have one.
fn has_display() -> bool {
    !cfg!(target_os = "linux")
        || ["WAYLAND_DISPLAY", "DISPLAY"]
            .iter()
            .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
}

fn without_display(path: Option<&Path>, why: &str) -> Result<(), Failure> {
    let deployment = match path {
        Some(path) => load(path, None)?.0,
        None => Arc::new(Sample::Warthog.open()?),
    };
    let analysis = Analyst::new(deployment.clone()).run(&Settings::default());
    let answer = analysis.answer.clone()?;
    let what = if path.is_some() { "" } else { "; this is the built-in sample" };
    print(&format!("{why}{what}\n\n{}", text::calibration(&deployment, &analysis, &answer)))?;
    print(
        "\nwindow      run resect where there is a display (over ssh: ssh -X, or xvfb-run)\n\
         picture     resect screenshot [PATH] --out window.png\n\
         your data   resect calibrate PATH [--json]\n",
    )?;
    Ok(())
}
