//! The solver of the joint estimate: its status, and a row for each step.

use egui::ScrollArea;

use super::{number_cell, number_head};
use crate::app::state::State;
use resect_core::calibration::joint::TraceEvent;
use resect_report::trace;

/// Width of each column (figures), in the order of [`trace::COLUMNS`].
const FIGURES: [usize; trace::COLUMNS.len()] = [4, 13, 10, 9, 11, 5, 6, 10];

pub fn ui(ui: &mut egui::Ui, state: &State) {
    let Some((_, analysis)) = state.analysed() else {
        ui.weak("Nothing open.");
        return;
    };
    let trace = analysis.answer.as_ref().ok().and_then(|answer| answer.calibration.trace());
    egui::Frame::new().inner_margin(8.0).show(ui, |ui| {
        let Some(trace) = trace else {
            ui.label("Only the joint estimate has steps.");
            return;
        };
        ui.strong(trace::status(trace));
        ScrollArea::both().auto_shrink(false).show(ui, |ui| {
            egui::Grid::new("solver").striped(true).show(ui, |ui| {
                for (title, figures) in trace::COLUMNS.into_iter().zip(FIGURES) {
                    number_head(ui, title, figures);
                }
                ui.strong("before the step");
                ui.end_row();
                for (index, row) in trace.rows.iter().enumerate() {
                    for (cell, figures) in trace::cells(index, row).into_iter().zip(FIGURES) {
                        number_cell(ui, cell, figures);
                    }
                    ui.label(in_words(&row.events));
                    ui.end_row();
                }
            });
            ui.label(in_words(&trace.last_events));
        });
    });
}

fn in_words(events: &[TraceEvent]) -> String {
    events.iter().map(TraceEvent::in_words).collect::<Vec<_>>().join("; ")
}
