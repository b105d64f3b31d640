//! Table of the reliability of the groups of readings.

use egui::RichText;

use crate::app::model::Units;
use crate::app::words;
use resect_core::calibration::Quantity;
use resect_core::calibration::joint::JointEstimate;
use resect_core::calibration::joint::reliability::{DetectableBias, GroupReliability};
use resect_core::deployment::ControlPointSet;
use resect_report::glossary;
use resect_report::rows::largest_residual;

/// Shows the table, folded; nothing without groups.
pub fn ui(ui: &mut egui::Ui, joint: &JointEstimate, sets: &[ControlPointSet], units: Units) {
    if joint.reliability.is_empty() {
        return;
    }
    let header = egui::CollapsingHeader::new("Reliability").id_salt("reliability");
    let header = header.show(ui, |ui| {
        egui::ScrollArea::horizontal().id_salt("reliability").show(ui, |ui| {
            table(ui, &joint.reliability, sets, units);
        });
        ui.small(
            "Residual: normalised, of a drive the root mean square, of control points the largest. Effect: largest displacement \
             of stations 2, 3, … by an undetected bias of the detectable size.",
        );
    });
    words::explain_all(
        header.header_response,
        &[&glossary::REDUNDANCY, &glossary::MINIMAL_DETECTABLE_BIAS],
    );
}

fn table(ui: &mut egui::Ui, groups: &[GroupReliability], sets: &[ControlPointSet], units: Units) {
    let grid = egui::Grid::new("reliability").num_columns(5).spacing([8.0, 2.0]).striped(true);
    grid.show(ui, |ui| {
        for name in ["", "redundancy", "residual", "detectable", "effect"] {
            ui.weak(name);
        }
        ui.end_row();
        let number = |value: Option<f64>| value.map_or("–".to_owned(), |it| format!("{it:.2}"));
        let mut subject = String::new();
        for group in groups {
            if group.subject() != subject {
                subject = group.subject();
                ui.strong(&subject);
                ui.end_row();
            }
            let cell = |text: String| RichText::new(text).monospace().size(11.0);
            ui.label(format!("  {}", group.kind.name()));
            ui.label(cell(number(group.redundancy)));
            let residual = ui.label(cell(number(group.residual_sigmas())));
            if let Some(point) = largest_residual(sets, group) {
                residual.on_hover_text(point);
            }
            match &group.bias {
                Some(bias) => {
                    ui.label(cell(units.prior(group.kind.quantity(), bias.size)));
                    ui.label(cell(units.prior(Quantity::Length, bias.position_m())))
                        .on_hover_text(effect(bias, units));
                }
                None => {
                    ui.label(cell("–".to_owned())).on_hover_text("Not determined");
                    ui.label(cell("–".to_owned()));
                }
            }
            ui.end_row();
        }
    });
}

/// Effect on both transforms: "T12: 1.2 mm, 0.031 mrad; T13: 0.8 mm, 0.012 mrad".
fn effect(bias: &DetectableBias, units: Units) -> String {
    let of_station = |slot: usize| {
        let effect = &bias.effect[slot];
        let position = units.prior(Quantity::Length, effect.position_m);
        format!("T1{}: {position}, {}", slot + 2, units.prior(Quantity::Angle, effect.yaw_rad))
    };
    [0, 1].map(of_station).join("; ")
}
