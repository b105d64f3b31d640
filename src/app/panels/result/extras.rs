//! What was estimated beside the transforms, and what their σ are made of, as tables.

use egui::RichText;

use crate::app::model::estimates::column;
use crate::app::model::{OpenDeployment, Units};
use crate::app::words;
use resect_core::calibration::joint::{Dominant, JointEstimate};
use resect_core::calibration::{Calibration, Extra, Quantity};
use resect_report::glossary;

/// Shows the tables, folded; nothing where nothing was estimated.
pub fn ui(ui: &mut egui::Ui, open: &OpenDeployment, calibration: &Calibration, units: Units) {
    let extras = calibration.extras(&open.deployment);
    if extras.is_empty() {
        return;
    }
    let notable = extras.iter().filter(|extra| extra.notable).count();
    let title = match notable {
        0 => format!("Estimated besides ({}, none told from zero)", extras.len()),
        _ => format!("Estimated besides ({}, {notable} told from zero)", extras.len()),
    };
    egui::CollapsingHeader::new(title).id_salt("extras").show(ui, |ui| {
        table(ui, &extras, units);
        ui.small("→ told from zero. Known before: one σ without this drive.");
    });
    if let Some(joint) = calibration.joint() {
        let header = egui::CollapsingHeader::new("What σ comes from").id_salt("budget");
        let header = header.show(ui, |ui| {
            scatter(ui, joint, units);
            budget(ui, joint, units);
        });
        words::explain(header.header_response, &glossary::SIGMA);
    }
}

fn table(ui: &mut egui::Ui, extras: &[Extra], units: Units) {
    let shown: Vec<_> =
        extras.iter().map(|extra| units.extra(extra.quantity, extra.estimate)).collect();
    egui::Grid::new("extras").num_columns(3).spacing([6.0, 2.0]).striped(true).show(ui, |ui| {
        for name in ["", "value ± 1 σ", "known before"] {
            ui.weak(name);
        }
        ui.end_row();
        let mut of = "";
        for (extra, cell) in extras.iter().zip(column(&shown)) {
            if extra.of != of {
                of = &extra.of;
                ui.strong(of);
                ui.end_row();
            }
            let mark = if extra.notable { " →" } else { "" };
            ui.label(format!("  {}{mark}", extra.name));
            ui.label(RichText::new(cell).monospace().size(11.0));
            let prior =
                extra.prior.map_or("–".to_owned(), |sigma| units.prior(extra.quantity, sigma));
            ui.small(format!("± {prior}"));
            ui.end_row();
        }
    });
}

/// How the readings scatter about the motion.
fn scatter(ui: &mut egui::Ui, joint: &JointEstimate, units: Units) {
    let levels = &joint.levels;
    egui::Grid::new("scatter").num_columns(2).spacing([10.0, 2.0]).striped(true).show(ui, |ui| {
        ui.strong("Readings scatter");
        ui.weak("1 σ");
        ui.end_row();
        for (name, quantity, sigma) in [
            ("range", Quantity::Length, levels.range_m()),
            ("angle", Quantity::Angle, levels.angle_rad),
            ("time", Quantity::Time, levels.jitter_s),
            ("wander of ranges", Quantity::Length, joint.wander.sigma_m),
        ] {
            ui.label(format!("  {name}"));
            ui.monospace(units.prior(quantity, sigma));
            ui.end_row();
        }
    });
}

/// The largest part of each σ of the transforms.
fn budget(ui: &mut egui::Ui, joint: &JointEstimate, units: Units) {
    egui::Grid::new("budget").num_columns(3).spacing([10.0, 2.0]).striped(true).show(ui, |ui| {
        for (index, transform) in ["T12", "T13"].into_iter().enumerate() {
            ui.strong(format!("σ of {transform}"));
            ui.weak("mostly from");
            ui.weak("whole σ");
            ui.end_row();
            for (axis, name) in ["x", "y", "z", "yaw"].into_iter().enumerate() {
                let Dominant { what, part, whole } = joint.dominant(4 * index + axis);
                let quantity = if axis == 3 { Quantity::Angle } else { Quantity::Length };
                ui.label(format!("  {name}"));
                ui.label(format!("{what}, {}", units.prior(quantity, part)));
                ui.monospace(units.prior(quantity, whole));
                ui.end_row();
            }
        }
    });
}
