//! The bar at the top: opening, the deployment's name, what is under way, views and theme.

use eframe::egui;

use crate::app::layout::Pane;
use crate::app::scene::ViewPreset;
use crate::app::state::{Command, Commands, State};
use crate::deployment::Sample;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    egui::Panel::top("top bar").show(ui, |ui| {
        egui::MenuBar::new().ui(ui, |ui| {
            ui.strong("resect");
            ui.separator();
            ui.menu_button("Open", |ui| {
                if ui.button("Folder…").clicked() {
                    commands.push(Command::OpenFolderDialog);
                    ui.close();
                }
                if ui.button("Bag or CSV…").clicked() {
                    commands.push(Command::OpenFileDialog);
                    ui.close();
                }
                ui.separator();
                for sample in Sample::ALL {
                    if ui.button(format!("Sample: {}", sample.title())).clicked() {
                        commands.push(Command::OpenSample(sample));
                        ui.close();
                    }
                }
            });
            ui.menu_button("Export", |ui| {
                ui.add_enabled_ui(state.analysed().is_some(), |ui| {
                    if ui.button("Open in Rerun").clicked() {
                        commands.push(Command::OpenInRerun);
                        ui.close();
                    }
                    if ui.button("Save for Rerun (.rrd)…").clicked() {
                        commands.push(Command::SaveRecordingDialog);
                        ui.close();
                    }
                    if ui.button("Save the trajectory (.tum)…").clicked() {
                        commands.push(Command::SaveTrajectoryDialog);
                        ui.close();
                    }
                });
            });
            ui.menu_button("View", |ui| {
                for (name, preset) in [
                    ("Fit (F)", ViewPreset::Fit),
                    ("Top", ViewPreset::Top),
                    ("Side", ViewPreset::Side),
                ] {
                    if ui.button(name).clicked() {
                        commands.push(Command::Look(preset));
                        ui.close();
                    }
                }
                ui.separator();
                for pane in Pane::ALL {
                    if ui.button(pane.title()).clicked() {
                        commands.push(Command::ShowPane(pane));
                        ui.close();
                    }
                }
                ui.separator();
                if ui.button("Reset layout").clicked() {
                    commands.push(Command::ResetLayout);
                    ui.close();
                }
                ui.separator();
                ui.label("Theme");
                let mut theme = ui.ctx().options(|options| options.theme_preference);
                theme.buttons(ui);
                ui.ctx().set_theme(theme);
            });
            ui.separator();
            match state.active() {
                Some(open) => ui.label(&open.deployment.name),
                None => ui.weak("nothing open: choose Open, or drop a folder or bag here"),
            };
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if state.is_busy() {
                    ui.add(egui::Spinner::new().size(14.0));
                }
                if let Some(elapsed_ms) = state.elapsed_ms() {
                    ui.label(format!("{elapsed_ms:.1} ms"))
                        .on_hover_text("From the settings to the new residuals, in the background");
                }
            });
        });
    });
}
