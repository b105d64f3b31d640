//! The panes that are lists of widgets: each a function that reads the state and sends commands.

pub mod asked;
pub mod command_palette;
pub mod control_points;
pub mod correlations;
pub mod deployment;
pub mod drop_hint;
pub mod empty_state;
pub mod findings;
pub mod minima;
mod number;
pub mod observability;
pub mod path_prompt;
pub mod pipeline;
pub mod progress;
pub mod put_right;
pub mod reading;
pub mod result;
pub mod runs;
pub mod shortcuts;
pub mod side_by_side;
pub mod studies;
pub mod time_bar;
pub mod toasts;
pub mod top_bar;
pub mod validation;

use eframe::egui;

use crate::app::theme;
use crate::deployment::Finding;

/// What takes less is not worth a word.
const SHORTEST_WAIT: std::time::Duration = std::time::Duration::from_millis(250);

/// A pane's content with a margin, scrolling where it does not fit.
fn scrolled(ui: &mut egui::Ui, add: impl FnOnce(&mut egui::Ui)) {
    egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        egui::Frame::new().inner_margin(8.0).show(ui, |ui| {
            ui.set_width(ui.available_width());
            add(ui);
        });
    });
}

/// A finding with its sign; the text wraps beside it.
fn finding(ui: &mut egui::Ui, finding: &Finding) {
    let (colour, sign) = theme::severity(finding.severity, ui.visuals().dark_mode);
    ui.horizontal_top(|ui| {
        // Signs differ in width; the texts beside them should line up.
        let width = 14.0;
        let (place, _) = ui.allocate_exact_size(egui::vec2(width, 16.0), egui::Sense::hover());
        let font = egui::TextStyle::Body.resolve(ui.style());
        ui.painter().text(place.center(), egui::Align2::CENTER_CENTER, sign, font, colour);
        ui.add(egui::Label::new(&finding.message).wrap());
    });
}

/// A heading inside a pane.
fn heading(ui: &mut egui::Ui, text: &str) {
    ui.add_space(4.0);
    ui.strong(text);
}
