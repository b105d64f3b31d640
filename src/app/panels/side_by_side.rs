//! The results of all open deployments beside each other.

use eframe::egui::{self, RichText};

use crate::analysis::Settings;
use crate::app::open_deployment::OpenDeployment;
use crate::app::state::{Command, Commands, State};
use crate::app::theme;
use crate::deployment::Severity;

const COLUMNS: [&str; 12] = [
    "deployment",
    "method",
    "verdict",
    "x12 (m)",
    "y12 (m)",
    "z12 (m)",
    "yaw12 (rad)",
    "x13 (m)",
    "y13 (m)",
    "z13 (m)",
    "yaw13 (rad)",
    "settings",
];

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    if state.open.is_empty() {
        ui.centered_and_justified(|ui| ui.weak("Nothing open."));
        return;
    }
    egui::ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        egui::Frame::new().inner_margin(8.0).show(ui, |ui| {
            let columns = COLUMNS.len() + 2;
            egui::Grid::new("side by side")
                .num_columns(columns)
                .spacing([14.0, 4.0])
                .striped(true)
                .show(ui, |ui| {
                    head(ui);
                    for open in &state.open {
                        row(ui, state, open, commands);
                        ui.end_row();
                    }
                });
            ui.small("± one standard deviation in mm and mrad; metrics are median / IQR in mm");
            let active = state.settings();
            let differ = state.open.iter().any(|open| open.settings != *active);
            if state.open.len() > 1
                && ui
                    .add_enabled(differ, egui::Button::new("Give all the active one's settings"))
                    .on_disabled_hover_text("They have the same settings already")
                    .clicked()
            {
                commands.push(Command::SetAll);
            }
        });
    });
}

fn head(ui: &mut egui::Ui) {
    for (index, name) in COLUMNS.iter().enumerate() {
        if index == 3 {
            ui.label(RichText::new("inter-prism (mm)").small());
            ui.label(RichText::new("control points (mm)").small());
        }
        ui.label(RichText::new(*name).small());
    }
    ui.end_row();
}

fn row(ui: &mut egui::Ui, state: &State, open: &OpenDeployment, commands: &mut Commands) {
    let active = state.active().is_some_and(|active| active.id == open.id);
    if ui.selectable_label(active, &open.deployment.name).clicked() {
        commands.push(Command::Activate(open.id));
    }
    let dashes = |ui: &mut egui::Ui, count: usize| {
        for _ in 0..count {
            ui.weak("–");
        }
    };
    match open.analysis.as_ref().map(|analysis| &analysis.answer) {
        None => dashes(ui, COLUMNS.len()),
        Some(Err(error)) => {
            let (colour, sign) = theme::severity(Severity::Problem, ui.visuals().dark_mode);
            ui.label("–");
            ui.label(RichText::new(format!("{sign} none")).color(colour))
                .on_hover_text(error.to_string());
            dashes(ui, COLUMNS.len() - 2);
        }
        Some(Ok(answer)) => {
            let calibration = &answer.calibration;
            let method = calibration.method;
            ui.label(method.letter().to_string()).on_hover_text(method.title());
            let (ground, ink) = theme::verdict(calibration.verdict);
            let word = RichText::new(format!(" {} ", calibration.verdict.name()));
            ui.label(word.color(ink).background_color(ground));
            let spread = |spread: Option<[f64; 2]>| {
                spread.map_or("–".to_owned(), |[median, iqr]| format!("{median:.2} / {iqr:.2}"))
            };
            let evaluation = &answer.evaluation;
            ui.monospace(spread(evaluation.inter_prism_mm.map(|s| [s.median, s.iqr])));
            // The worst file, as the verdict sees it.
            let worst = evaluation
                .control_points_mm
                .iter()
                .max_by(|a, b| a.spread.median.total_cmp(&b.spread.median));
            let cell = ui.monospace(spread(worst.map(|m| [m.spread.median, m.spread.iqr])));
            if let Some(worst) = worst {
                cell.on_hover_text(format!(
                    "{}, the worst of {}",
                    worst.file,
                    evaluation.control_points_mm.len()
                ));
            }
            for station in 1..3 {
                let transform = &calibration.station1_from_station[station];
                let sigma = calibration.sigma.map(|sigma| sigma[station - 1]);
                for axis in 0..3 {
                    let sigma = sigma.map(|s| s.translation_m[axis]);
                    ui.monospace(plus_minus(transform.translation_m[axis], sigma, 4, 1));
                }
                ui.monospace(plus_minus(transform.yaw_rad(), sigma.map(|s| s.yaw_rad), 5, 3));
            }
        }
    }
    ui.label(if open.settings == Settings::default() { "paper's" } else { "changed" })
        .on_hover_text(serde_json::to_string_pretty(&open.settings).unwrap_or_default());
}

fn plus_minus(value: f64, sigma: Option<f64>, digits: usize, sigma_digits: usize) -> String {
    let sigma = sigma.map_or("–".to_owned(), |s| format!("{:.sigma_digits$}", s * 1e3));
    format!("{value:.digits$} ± {sigma}")
}
