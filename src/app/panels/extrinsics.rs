//! Pose of each trajectory's body in that of a ground truth that is a trajectory, folded below the errors.

use egui::RichText;

use super::{number_cell, number_head};
use crate::app::model::{Commands, JudgingCommand, OpenDeployment, WorkspaceCommand};
use crate::app::theme;
use resect_report::extrinsics::{
    QuantityRow, advice_in_words, conclusion, extrinsics_copy, headline, quantities,
};
use resect_report::named_transform::TransformFormat;
use resect_tools::extrinsics::Extrinsics;
use resect_tools::palette;

/// Width of the numbers (digits).
const FIGURES: usize = 26;

pub fn ui(ui: &mut egui::Ui, open: &OpenDeployment, commands: &mut Commands) {
    if open.deployment.ground_truth.is_none() {
        return;
    }
    let judging = &open.judging;
    let header = egui::CollapsingHeader::new("Extrinsic calibration").id_salt("extrinsics");
    let shown = header.show(ui, |ui| {
        if judging.extrinsics.is_running() {
            ui.horizontal(|ui| {
                ui.spinner();
                ui.label("estimating");
            });
        }
        for outcome in judging.extrinsics.newest.iter().flat_map(|all| all.iter()) {
            match outcome {
                Ok(extrinsics) => calibration(ui, extrinsics, commands),
                Err(why) => {
                    ui.add(egui::Label::new(why.to_string()).wrap());
                }
            }
            ui.add_space(4.0);
        }
    });
    shown.header_response.on_hover_text("Pose of each body in that of the ground truth, with σ");
    let is_open = shown.body_response.is_some();
    if is_open != judging.shows_extrinsics {
        commands.push(JudgingCommand::ShowExtrinsics(is_open).into());
    }
}

fn calibration(ui: &mut egui::Ui, extrinsics: &Extrinsics, commands: &mut Commands) {
    ui.add(egui::Label::new(headline(extrinsics)).wrap());
    ui.horizontal_wrapped(|ui| {
        let [ground, ink] = palette::verdict(extrinsics.verdict).map(theme::rgb);
        let word = format!(" {} ", extrinsics.verdict.name());
        ui.label(RichText::new(word).color(ink).background_color(ground).strong());
        ui.label(conclusion(extrinsics));
    });
    let grid = egui::Grid::new(("extrinsics", &extrinsics.names)).striped(true);
    grid.spacing([10.0, 2.0]).show(ui, |ui| {
        ui.label("");
        number_head(ui, "value", FIGURES);
        ui.small("halves differ by");
        ui.end_row();
        for QuantityRow { label, value, halves } in quantities(extrinsics) {
            ui.label(label);
            number_cell(ui, value, FIGURES);
            ui.label(halves.unwrap_or_default());
            ui.end_row();
        }
    });
    for advised in &extrinsics.advice {
        let line = format!("Next: {}.", advice_in_words(advised, &extrinsics.names[0]));
        ui.add(egui::Label::new(line).wrap());
    }
    for finding in &extrinsics.findings {
        ui.add(egui::Label::new(format!("{} {finding}", finding.severity.mark())).wrap());
    }
    ui.menu_button("Copy as…", |ui| {
        for format in TransformFormat::ALL {
            if ui.button(format.title()).clicked() {
                let text = extrinsics_copy(extrinsics, None, format);
                commands.push(WorkspaceCommand::Copy(text).into());
                ui.close();
            }
        }
    });
}
