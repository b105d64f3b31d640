//! What is open: stations with their counts and visibility, files, rig.

use eframe::egui;

use super::{finding, heading, scrolled};
use crate::app::state::{Command, Commands, State};
use crate::app::theme;
use crate::deployment::{Sample, Severity, pair_label};
use crate::palette;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    scrolled(ui, |ui| {
        let Some(deployment) = &state.deployment else {
            ui.label("Open a folder with a deployment, or start with a sample:");
            for sample in Sample::ALL {
                if ui.button(sample.title()).clicked() {
                    commands.push(Command::OpenSample(sample));
                }
            }
            return;
        };
        let dark = ui.visuals().dark_mode;
        let mut visibility = state.visibility;
        let duration_s = match (deployment.start_s(), deployment.end_s()) {
            (Some(start), Some(end)) => end - start,
            _ => 0.0,
        };
        ui.strong(&deployment.name);
        ui.label(format!("{duration_s:.0} s of measurements"));
        ui.add_space(2.0);
        egui::Grid::new("stations").num_columns(3).spacing([10.0, 3.0]).show(ui, |ui| {
            for (station, track) in deployment.tracks.iter().enumerate() {
                let name = format!("Station {}", station + 1);
                let text = egui::RichText::new(name)
                    .color(theme::readable(palette::STATIONS[station], dark));
                ui.checkbox(&mut visibility.stations[station], text);
                ui.label(format!("{} readings", track.measurements.len()));
                ui.label(format!("to {:.0} m", state.longest_range_m[station]));
                ui.end_row();
            }
        });
        ui.horizontal_wrapped(|ui| {
            ui.label("Show");
            ui.checkbox(&mut visibility.raw, "raw");
            ui.checkbox(&mut visibility.tracks, "tracks");
            ui.add_enabled_ui(!deployment.control_points.is_empty(), |ui| {
                ui.checkbox(&mut visibility.control_points, "control points");
            });
        });
        if visibility != state.visibility {
            commands.push(Command::Show(visibility));
        }

        heading(ui, "Rig");
        match &deployment.rig {
            None => {
                ui.label("Inter-prism distances unknown.");
            }
            Some(rig) => {
                egui::Grid::new("rig").num_columns(2).spacing([10.0, 2.0]).show(ui, |ui| {
                    for (pair, distance) in rig.inter_prism_m.iter().enumerate() {
                        ui.label(format!("Prisms {}", pair_label(pair)));
                        ui.monospace(format!("{distance:.4} m"));
                        ui.end_row();
                    }
                });
            }
        }

        heading(ui, "Files");
        for ingredient in &deployment.ingredients {
            let text = egui::RichText::new(&ingredient.file).small();
            let text = if ingredient.used { text } else { text.weak().strikethrough() };
            ui.add(egui::Label::new(text).truncate()).on_hover_text(ingredient.what);
        }
        if deployment.ingredients.iter().any(|i| !i.used) {
            ui.small("Struck out: not used; hover for the reason.");
        }
        for one in deployment.findings.iter().filter(|f| f.severity > Severity::Note) {
            finding(ui, one);
        }
    });
}
