//! What takes long: how far it is, and a way to stop it.

use eframe::egui;

use crate::app::model::{Command, Commands};
use crate::app::state::State;
use crate::progress::Progress;

const BAR_WIDTH: f32 = 110.0;

/// Work that is under way.
struct Job<'a> {
    what: String,
    progress: &'a Progress,
    stop: Command,
}

/// One bar for each opening and for a study; nothing while there is none.
pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    for job in jobs(state) {
        if ui.button("Cancel").on_hover_text(format!("Stop {}", job.what)).clicked() {
            commands.push(job.stop);
        }
        let share = job.progress.share();
        let bar = egui::ProgressBar::new(share.unwrap_or(0.0))
            .desired_width(BAR_WIDTH)
            .text(amount(job.progress));
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
        .opening
        .iter()
        .filter(|opening| opening.since.elapsed() > super::SHORTEST_WAIT)
        .map(|opening| Job {
            what: format!("opening {}", opening.title),
            progress: &opening.progress,
            stop: Command::CancelOpening(opening.number),
        })
        .collect();
    jobs.extend(state.studies.running.iter().map(|(_, progress)| Job {
        what: "running the study".to_owned(),
        progress,
        stop: Command::CancelStudy,
    }));
    jobs
}

/// Bytes as megabytes, steps as they are.
fn amount(progress: &Progress) -> String {
    let (done, total) = (progress.done(), progress.total());
    match total {
        0 => String::new(),
        1_000_000.. => format!("{:.0} of {:.0} MB", done as f64 / 1e6, total as f64 / 1e6),
        _ => format!("{:.0} %", 100.0 * done as f64 / total as f64),
    }
}
