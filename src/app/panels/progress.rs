//! Progress of long-running jobs, with buttons to cancel them.

use std::time::Duration;

use crate::app::model::{Command, Commands, DeploymentCommand, ResultsCommand};
use crate::app::state::State;
use resect_core::progress::Progress;

const BAR_WIDTH: f32 = 110.0;
/// Shorter calibrations show no bar, which would flicker while a slider is dragged.
const LONG_FOR_AN_ANSWER: Duration = Duration::from_secs(1);

/// A job in progress.
struct ShownJob<'a> {
    what: String,
    progress: &'a Progress,
    /// True if the job counts bytes.
    of_bytes: bool,
    stop: Command,
}

/// Shows one bar for each opening, each calibration and a study.
pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    for job in jobs(state) {
        if ui.button("Cancel").on_hover_text(format!("Stop {}", job.what)).clicked() {
            commands.push(job.stop.clone());
        }
        let share = job.progress.share();
        let bar = egui::ProgressBar::new(share.unwrap_or(0.0))
            .desired_width(BAR_WIDTH)
            .text(amount(&job));
        // Without a total, the bar shows activity and no percentage.
        let bar = ui.add(if share.is_none() { bar.animate(true) } else { bar });
        bar.widget_info(|| {
            let mut info =
                egui::WidgetInfo::labeled(egui::Role::ProgressIndicator, true, &job.what);
            info.value = share.map(|share| f64::from(100.0 * share));
            info
        });
        ui.label(job.what);
    }
}

/// Returns the jobs that have run long enough to be shown.
fn jobs(state: &State) -> Vec<ShownJob<'_>> {
    let mut jobs: Vec<ShownJob<'_>> = state
        .deployments
        .opening
        .iter()
        .zip(state.opening_names())
        .filter(|(opening, _)| opening.since.elapsed() > super::SHORTEST_WAIT)
        .map(|(opening, name)| ShownJob {
            what: format!("opening {name}"),
            progress: &opening.progress,
            of_bytes: true,
            stop: DeploymentCommand::CancelOpening(opening.number).into(),
        })
        .collect();
    jobs.extend(state.results.studies.running.iter().map(|(_, progress)| ShownJob {
        what: "running the study".to_owned(),
        progress,
        of_bytes: false,
        stop: ResultsCommand::CancelStudy.into(),
    }));
    jobs.extend(state.calibrating(LONG_FOR_AN_ANSWER).map(|(open, progress)| ShownJob {
        what: format!("calibrating {}", state.name_of(open.id).unwrap_or_default()),
        progress,
        of_bytes: false,
        stop: DeploymentCommand::CancelAnalysis(open.id).into(),
    }));
    jobs
}

/// Formats bytes as megabytes, and steps unchanged.
fn amount(ShownJob { progress, of_bytes, .. }: &ShownJob<'_>) -> String {
    let (done, total) = (progress.done(), progress.total());
    match total {
        0 => String::new(),
        1_000_000.. if *of_bytes => {
            format!("{:.0} of {:.0} MB", done as f64 / 1e6, total as f64 / 1e6)
        }
        _ => format!("{:.0} %", 100.0 * done as f64 / total as f64),
    }
}
