//! One line across the window: what went wrong, or what was done.

use eframe::egui::{self, Color32};

use crate::app::state::{Command, Commands, Notice, State};

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let Some(notice) = &state.notice else { return };
    let (text, fill, sign) = match notice {
        Notice::Error(text) => (text, Color32::from_rgb(150, 40, 30), "✗"),
        Notice::Done(text) => (text, Color32::from_rgb(20, 100, 75), "✓"),
    };
    let frame = egui::Frame::new().fill(fill).inner_margin(egui::Margin::symmetric(10, 6));
    egui::Panel::top("notice").frame(frame).show(ui, |ui| {
        ui.visuals_mut().override_text_color = Some(Color32::WHITE);
        ui.horizontal_wrapped(|ui| {
            ui.label(sign);
            ui.label(text);
            // The theme's own button would be white on white in the light one.
            if ui.add(egui::Button::new("Dismiss").fill(Color32::from_black_alpha(90))).clicked() {
                commands.push(Command::DismissNotice);
            }
        });
    });
}
