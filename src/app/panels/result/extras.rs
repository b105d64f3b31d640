//! Tables of the estimates other than the transforms, and of the sources of the transforms' σ.

use egui::RichText;

use crate::app::model::Units;
use crate::app::model::estimates::column;
use crate::app::words;
use resect_core::calibration::joint::{JointEstimate, LargestSource};
use resect_core::calibration::{Calibration, Quantity};
use resect_core::evaluation::answer_rows::{AnswerRow, RowGroup};
use resect_report::glossary;

/// Shows the tables, folded, if there are estimates other than the transforms.
pub fn ui(ui: &mut egui::Ui, rows: &[AnswerRow], calibration: &Calibration, units: Units) {
    let beside: Vec<&AnswerRow> =
        rows.iter().filter(|row| row.group.is_beside_transforms()).collect();
    if beside.is_empty() {
        return;
    }
    let significant = beside.iter().filter(|row| row.is_significant).count();
    let title = match significant {
        0 => format!("Other estimates ({}, none significant)", beside.len()),
        _ => format!("Other estimates ({}, {significant} significant)", beside.len()),
    };
    egui::CollapsingHeader::new(title).id_salt("extras").show(ui, |ui| {
        table(ui, &beside, units);
        ui.small("→ significant. Prior: 1 σ without this drive.");
    });
    if let Some(joint) = calibration.joint() {
        let header = egui::CollapsingHeader::new("Sources of σ").id_salt("budget");
        let header = header.show(ui, |ui| {
            scatter(ui, rows, units);
            budget(ui, joint, units);
        });
        words::explain(header.header_response, &glossary::SIGMA);
    }
}

fn table(ui: &mut egui::Ui, rows: &[&AnswerRow], units: Units) {
    let shown: Vec<_> = rows.iter().map(|row| units.deviation(row)).collect();
    egui::Grid::new("extras").num_columns(3).spacing([6.0, 2.0]).striped(true).show(ui, |ui| {
        for name in ["", "value ± 1 σ", "prior"] {
            ui.weak(name);
        }
        ui.end_row();
        let mut subject = "";
        for (row, cell) in rows.iter().zip(column(&shown)) {
            if row.subject != subject {
                subject = &row.subject;
                ui.strong(subject);
                ui.end_row();
            }
            let mark = if row.is_significant { " →" } else { "" };
            ui.label(format!("  {}{mark}", row.name)).on_hover_text(&row.symbol);
            ui.label(RichText::new(cell).monospace().size(11.0));
            let prior = row.prior.map_or("–".to_owned(), |sigma| {
                format!("± {}", units.prior(row.quantity, sigma))
            });
            ui.small(prior);
            ui.end_row();
        }
    });
}

/// Shows the noise of the readings relative to the motion.
fn scatter(ui: &mut egui::Ui, rows: &[AnswerRow], units: Units) {
    egui::Grid::new("scatter").num_columns(2).spacing([10.0, 2.0]).striped(true).show(ui, |ui| {
        ui.strong("Noise of readings");
        ui.weak("1 σ");
        ui.end_row();
        for row in rows.iter().filter(|row| row.group == RowGroup::Noise) {
            ui.label(format!("  {}", row.name));
            ui.monospace(units.prior(row.quantity, row.value));
            ui.end_row();
        }
    });
}

/// Shows the largest contribution to each σ of the transforms.
fn budget(ui: &mut egui::Ui, joint: &JointEstimate, units: Units) {
    egui::Grid::new("budget").num_columns(3).spacing([10.0, 2.0]).striped(true).show(ui, |ui| {
        for (index, transform) in ["T12", "T13"].into_iter().enumerate() {
            ui.strong(format!("σ of {transform}"));
            ui.weak("largest source");
            ui.weak("total σ");
            ui.end_row();
            for (axis, name) in ["x", "y", "z", "yaw"].into_iter().enumerate() {
                let LargestSource { name: source, sigma, total_sigma } =
                    joint.largest_source(4 * index + axis);
                let quantity = if axis == 3 { Quantity::Angle } else { Quantity::Length };
                ui.label(format!("  {name}"));
                ui.label(format!("{source}, {}", units.prior(quantity, sigma)));
                ui.monospace(units.prior(quantity, total_sigma));
                ui.end_row();
            }
        }
    });
}
