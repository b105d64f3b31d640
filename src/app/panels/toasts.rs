//! The toasts, stacked at the lower right.

use eframe::egui::{self, Color32, RichText, accesskit};

use crate::app::model::toasts::{Toast, ToastLevel, Toasts};
use crate::app::model::{Command, Commands};
use crate::app::theme;
use crate::deployment::Severity;
use crate::palette;

const WIDTH: f32 = 360.0;
const MARGIN: f32 = 12.0;
/// The bar of time stays in sight below them.
const BOTTOM: f32 = 34.0;

pub fn ui(ctx: &egui::Context, toasts: &Toasts, commands: &mut Commands) {
    if toasts.shown().is_empty() {
        return;
    }
    egui::Area::new(egui::Id::unique("toasts"))
        .order(egui::Order::Middle)
        .anchor(egui::Align2::RIGHT_BOTTOM, [-MARGIN, -BOTTOM])
        .show(ctx, |ui| {
            ui.set_width(WIDTH.min(ui.ctx().content_rect().width() - 2.0 * MARGIN));
            for toast in toasts.shown() {
                show(ui, toast, commands);
            }
        });
}

fn show(ui: &mut egui::Ui, toast: &Toast, commands: &mut Commands) {
    let (colour, sign) = colour_and_sign(toast.level, ui.visuals().dark_mode);
    let frame = egui::Frame::popup(ui.style())
        .stroke(egui::Stroke::new(1.0, colour))
        .inner_margin(egui::Margin::symmetric(10, 8));
    let shown = frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(sign).color(colour).strong());
            ui.vertical(|ui| {
                let text =
                    ui.add(egui::Label::new(RichText::new(shortened(&toast.text)).strong()).wrap());
                // Screen readers say it when it appears; errors at once.
                let urgency = match toast.level {
                    ToastLevel::Error => accesskit::Live::Assertive,
                    ToastLevel::Done | ToastLevel::Warning => accesskit::Live::Polite,
                };
                ui.ctx().accesskit_node_builder(text.id, |node| node.set_live(urgency));
                if !toast.detail.is_empty() {
                    ui.add(egui::Label::new(shortened(&toast.detail)).wrap());
                }
                ui.horizontal(|ui| {
                    if let Some((name, command)) = &toast.action
                        && ui.button(*name).clicked()
                    {
                        commands.extend([command.clone(), Command::DismissToast(toast.id)]);
                    }
                    if ui.button("Dismiss").clicked() {
                        commands.push(Command::DismissToast(toast.id));
                    }
                });
            });
        });
    });
    if ui.rect_contains_pointer(shown.response.rect) {
        commands.push(Command::HoldToast(toast.id));
    }
}

/// The sign tells the level without its colour.
fn colour_and_sign(level: ToastLevel, dark: bool) -> (Color32, &'static str) {
    match level {
        ToastLevel::Done => (theme::readable(palette::DONE, dark), "✓"),
        ToastLevel::Warning => theme::severity(Severity::Warning, dark),
        ToastLevel::Error => theme::severity(Severity::Problem, dark),
    }
}

/// The beginning of a text that would fill the window; the whole of it is in the findings or on the command line.
fn shortened(text: &str) -> String {
    const MOST: usize = 320;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
