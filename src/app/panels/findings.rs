//! All findings of the readers, the pipeline and the solver.

use super::{finding, heading, scrolled};
use crate::app::model::Commands;
use crate::app::state::State;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    scrolled(ui, |ui| {
        let Some(open) = state.active() else {
            ui.weak("Nothing open.");
            return;
        };
        heading(ui, "Reading");
        for one in &open.deployment.findings {
            finding(ui, state, one, commands);
        }
        let Some(analysis) = &open.analysis else { return };
        heading(ui, "Calibration");
        match &analysis.answer {
            Ok(answer) => {
                let mut findings: Vec<_> = answer.calibration.findings.iter().collect();
                findings.sort_by_key(|one| std::cmp::Reverse(one.severity));
                findings.into_iter().for_each(|one| finding(ui, state, one, commands));
            }
            Err(error) => finding(ui, state, &error.finding(), commands),
        }
    });
}
