//! The results of all open deployments beside each other: a column each.

use eframe::egui::{self, RichText};

use super::validation;
use crate::analysis::{Answer, Settings};
use crate::app::model::{Command, Commands, OpenDeployment};
use crate::app::state::State;
use crate::app::theme;
use crate::calibration::Calibration;
use crate::deployment::Severity;
use crate::evaluation::{ControlPointMetric, Spread};
use crate::palette;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    if state.open.is_empty() {
        ui.centered_and_justified(|ui| ui.weak("Nothing open."));
        return;
    }
    let width = ui.available_width() - 24.0;
    egui::ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        egui::Frame::new().inner_margin(8.0).show(ui, |ui| {
            egui::Grid::new("side by side")
                .num_columns(state.open.len() + 1)
                .spacing([18.0, 4.0])
                .min_col_width(120.0)
                .striped(true)
                .show(ui, |ui| rows(ui, state, commands));
            let small = state.units.angle.small_name();
            ui.small(format!("± one standard deviation in mm and {small}"));
            give_all(ui, state, commands);
            validation::ui(ui, state, width, commands);
        });
    });
}

fn rows(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    ui.label("");
    for open in &state.open {
        let active = state.active().is_some_and(|active| active.id == open.id);
        let name = RichText::new(&open.deployment.name).strong();
        if ui.selectable_label(active, name).clicked() {
            commands.push(Command::Activate(open.id));
        }
    }
    ui.end_row();
    row(ui, state, "verdict", |ui, calibration, _| {
        let [ground, ink] = palette::verdict(calibration.verdict).map(theme::rgb);
        let word = RichText::new(format!(" {} ", calibration.verdict.name()));
        let caveat = calibration.verdict.caveat(calibration.is_independently_checked());
        // One cell of the grid.
        ui.horizontal(|ui| {
            ui.label(word.color(ink).background_color(ground));
            if !caveat.is_empty() {
                ui.small(caveat.trim_start_matches(", "));
            }
        });
    });
    row(ui, state, "method", |ui, calibration, _| {
        ui.label(calibration.method.label());
    });
    row(ui, state, "inter-prism median / IQR (mm)", |ui, _, answer| {
        spread(ui, answer.evaluation.inter_prism_mm.as_ref());
    });
    row(ui, state, "worst control points (mm)", |ui, _, answer| {
        let files = &answer.evaluation.control_points_mm;
        let worst = ControlPointMetric::worst(files);
        let cell = spread(ui, worst.map(|metric| &metric.spread));
        if let Some(worst) = worst {
            cell.on_hover_text(format!("{}, the worst of {}", worst.file, files.len()));
        }
    });
    let units = state.units;
    for station in 1..3 {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let name = format!("{name} of T1{} ({})", station + 1, units.length.name());
            row(ui, state, &name, |ui, calibration, _| {
                let value_m = calibration.station1_from_station[station].translation_m[axis];
                let sigma_m = calibration.sigma.map(|s| s[station - 1].translation_m[axis]);
                let (value, sigma) = (units.length(value_m), units.length_sigma(sigma_m));
                ui.monospace(format!("{value:>9} ± {sigma}"));
            });
        }
        let name = format!("yaw of T1{} ({})", station + 1, units.angle.name());
        row(ui, state, &name, |ui, calibration, _| {
            let value_rad = calibration.station1_from_station[station].yaw_rad();
            let sigma_rad = calibration.sigma.map(|s| s[station - 1].yaw_rad);
            let (value, sigma) = (units.angle(value_rad), units.angle_sigma(sigma_rad));
            ui.monospace(format!("{value:>9} ± {sigma}"));
        });
    }
    ui.label("triplets");
    for open in &state.open {
        let count = open.analysis.as_ref().map(|a| a.pipeline.triplets.len().to_string());
        ui.monospace(count.unwrap_or_else(|| "–".to_owned()));
    }
    ui.end_row();
    ui.label("settings");
    for open in &state.open {
        let name = if open.settings == Settings::default() { "the defaults" } else { "changed" };
        let all = serde_json::to_string_pretty(&open.settings).unwrap_or_default();
        ui.label(name).on_hover_text(all);
    }
    ui.end_row();
}

/// One quantity of every deployment; those without an answer have a dash, and why on hover.
fn row(
    ui: &mut egui::Ui,
    state: &State,
    name: &str,
    cell: impl Fn(&mut egui::Ui, &Calibration, &Answer),
) {
    ui.label(name);
    for open in &state.open {
        match newest(open) {
            Some(Ok(answer)) => cell(ui, &answer.calibration, answer),
            Some(Err(why)) => {
                let (colour, sign) = theme::severity(Severity::Problem, ui.visuals().dark_mode);
                ui.label(RichText::new(sign).color(colour)).on_hover_text(why);
            }
            None => {
                ui.weak("–");
            }
        }
    }
    ui.end_row();
}

fn newest(open: &OpenDeployment) -> Option<Result<&Answer, String>> {
    let answer = &open.analysis.as_ref()?.answer;
    Some(answer.as_deref().map_err(|error| error.finding().message))
}

fn spread(ui: &mut egui::Ui, spread: Option<&Spread>) -> egui::Response {
    let text = spread.map_or("–".to_owned(), |s| format!("{:.2} / {:.2}", s.median, s.iqr));
    ui.monospace(text)
}

fn give_all(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    if state.open.len() < 2 {
        return;
    }
    let differ = state.open.iter().any(|open| open.settings != *state.settings());
    let button = egui::Button::new("Give all the active one's settings");
    let response = ui
        .add_enabled(differ, button)
        .on_disabled_hover_text("They have the same settings already");
    if response.clicked() {
        commands.push(Command::SetAll);
    }
}
