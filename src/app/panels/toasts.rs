//! The toasts, in a separate strip above the time bar, so that they cover no data.

use egui::{Color32, RichText, accesskit};

use crate::app::model::toasts::{Toast, ToastLevel, Toasts};
use crate::app::model::{Command, Commands, Units, WorkspaceCommand};
use crate::app::theme;
use resect_core::deployment::Severity;
use resect_tools::palette;

/// More lines than this scroll.
const MOST_LINES: f32 = 5.0;

pub fn ui(ui: &mut egui::Ui, toasts: &Toasts, units: Units, commands: &mut Commands) {
    // The layout must not move under a drag, so the strip waits until the button is released.
    let held = ui.input(|input| input.pointer.any_down());
    let id = egui::Id::unique("toasts");
    let last: f32 = ui.data(|data| data.get_temp(id)).unwrap_or(0.0);
    let hidden = if held { last == 0.0 } else { toasts.shown().is_empty() };
    if hidden {
        ui.data_mut(|data| data.insert_temp(id, 0.0_f32));
        return;
    }
    let line = ui.spacing().interact_size.y + ui.spacing().item_spacing.y;
    let mut panel = egui::Panel::bottom("toasts").resizable(false);
    if held {
        panel = panel.exact_size(last);
    }
    let shown = panel.show(ui, |ui| {
        egui::ScrollArea::vertical()
            .max_height(MOST_LINES * line)
            // A growing strip otherwise gets no more room than in the last frame.
            .min_scrolled_height(if held { 0.0 } else { MOST_LINES * line })
            .auto_shrink([false, true])
            .stick_to_bottom(true)
            .show(ui, |ui| {
                toasts.shown().iter().for_each(|toast| show(ui, toast, units, commands));
            });
    });
    if !held {
        ui.data_mut(|data| data.insert_temp(id, shown.response.rect.height()));
    }
}

fn show(ui: &mut egui::Ui, toast: &Toast, units: Units, commands: &mut Commands) {
    let (colour, sign) = colour_and_sign(toast.level, ui.visuals().dark_mode);
    let line = ui.with_layout(egui::Layout::right_to_left(egui::Align::TOP), |ui| {
        if ui.button("Dismiss").clicked() {
            commands.push(WorkspaceCommand::DismissToast(toast.id).into());
        }
        if let Some((name, command)) = &toast.action
            && ui.button(*name).clicked()
        {
            commands.extend([
                command.clone(),
                Command::Workspace(WorkspaceCommand::DismissToast(toast.id)),
            ]);
        }
        ui.with_layout(egui::Layout::left_to_right(egui::Align::TOP), |ui| {
            ui.label(RichText::new(sign).color(colour).strong());
            words(ui, toast, units);
        });
    });
    if ui.rect_contains_pointer(line.response.rect) {
        commands.push(WorkspaceCommand::HoldToast(toast.id).into());
    }
}

/// Shows the event, its count, and its reason or remedy.
fn words(ui: &mut egui::Ui, toast: &Toast, units: Units) {
    let [mut text, detail] = toast.lines(units).map(|line| shortened(&line));
    if toast.count > 1 {
        text += &format!(" ({}×)", toast.count);
    }
    let mut job = egui::text::LayoutJob::default();
    let mut add = |text: RichText| {
        let style = ui.style();
        text.append_to(&mut job, style, egui::FontSelection::Default, egui::Align::Center);
    };
    add(RichText::new(&text).strong());
    if !detail.is_empty() {
        add(RichText::new(format!("   {detail}")));
    }
    let label = ui.add(egui::Label::new(job).wrap());
    // Screen readers announce a toast when it appears; errors interrupt.
    let urgency = match toast.level {
        ToastLevel::Error => accesskit::Live::Assertive,
        ToastLevel::Done | ToastLevel::Warning => accesskit::Live::Polite,
    };
    ui.ctx().accesskit_node_builder(label.id, |node| node.set_live(urgency));
}

/// Colour and sign of a level; the sign identifies it without colour.
fn colour_and_sign(level: ToastLevel, dark: bool) -> (Color32, &'static str) {
    match level {
        ToastLevel::Done => (theme::readable(palette::DONE, dark), "✓"),
        ToastLevel::Warning => theme::severity(Severity::Warning, dark),
        ToastLevel::Error => theme::severity(Severity::Problem, dark),
    }
}

/// Truncates a text that would fill the window; findings or the command line show all of it.
fn shortened(text: &str) -> String {
    const MOST: usize = 320;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
