//! What takes long: how far it is, and a way to stop it.

use std::time::Duration;

use crate::app::model::{Command, Commands, DeploymentCommand, ResultsCommand};
use crate::app::state::State;
use resect_core::progress::Progress;

const BAR_WIDTH: f32 = 110.0;
/// An answer that takes less needs no bar: a slider that is dragged would make it flicker.
const LONG_FOR_AN_ANSWER: Duration = Duration::from_secs(1);

/// Work that is under way.
struct Job<'a> {
    what: String,
    progress: &'a Progress,
    /// Whether it counts bytes.
    of_bytes: bool,
    stop: Command,
}

/// One bar for each opening, each calibration and a study; nothing while there is none.
pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    for job in jobs(state) {
        if ui.button("Cancel").on_hover_text(format!("Stop {}", job.what)).clicked() {
            commands.push(job.stop.clone());
        }
        let share = job.progress.share();
        let bar = egui::ProgressBar::new(share.unwrap_or(0.0))
            .desired_width(BAR_WIDTH)
            .text(amount(&job));
        // Without a total it shows that something moves, and no share.
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

/// The jobs that have taken long enough to be worth a word.
fn jobs(state: &State) -> Vec<Job<'_>> {
    let mut jobs: Vec<Job<'_>> = state
        .deployments
        .opening
        .iter()
        .zip(state.opening_names())
        .filter(|(opening, _)| opening.since.elapsed() > super::SHORTEST_WAIT)
        .map(|(opening, name)| Job {
            what: format!("opening {name}"),
            progress: &opening.progress,
            of_bytes: true,
            stop: DeploymentCommand::CancelOpening(opening.number).into(),
        })
        .collect();
    jobs.extend(state.results.studies.running.iter().map(|(_, progress)| Job {
        what: "running the study".to_owned(),
        progress,
        of_bytes: false,
        stop: ResultsCommand::CancelStudy.into(),
    }));
    jobs.extend(state.calibrating(LONG_FOR_AN_ANSWER).map(|(open, progress)| Job {
        what: format!("calibrating {}", state.name_of(open.id).unwrap_or_default()),
        progress,
        of_bytes: false,
        stop: DeploymentCommand::CancelAnalysis(open.id).into(),
    }));
    jobs
}

/// Bytes as megabytes, steps as they are.
fn amount(Job { progress, of_bytes, .. }: &Job<'_>) -> String {
    let (done, total) = (progress.done(), progress.total());
    match total {
        0 => String::new(),
        1_000_000.. if *of_bytes => {
            format!("{:.0} of {:.0} MB", done as f64 / 1e6, total as f64 / 1e6)
        }
        _ => format!("{:.0} %", 100.0 * done as f64 / total as f64),
    }
}
