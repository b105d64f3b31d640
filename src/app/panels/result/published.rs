//! The paper's result beside a joint estimate: their difference, and a button that shows it.

use super::difference_row::{BESIDE, IN_SIGMA, difference_row};
use crate::app::model::{Commands, DeploymentCommand};
use crate::app::panels::{heading, number_head};
use crate::app::state::State;
use crate::app::words;
use resect_core::calibration::Calibration;
use resect_report::difference::moved_from_published;
use resect_report::glossary;

/// Shows the paper's result beside a joint estimate, if there is one.
pub fn ui(ui: &mut egui::Ui, state: &State, joint: &Calibration, commands: &mut Commands) {
    let (Some(published), Some(moved)) = (&joint.published, moved_from_published(joint)) else {
        return;
    };
    let name = published.method.short_name();
    let units = state.workspace.units;
    heading(ui, &format!("Difference from the paper's {name}"));
    for (part, moved) in moved.chunks(BESIDE).enumerate() {
        egui::Grid::new(("moved from published", part))
            .num_columns(1 + 2 * moved.len())
            .spacing([7.0, 3.0])
            .striped(true)
            .show(ui, |ui| {
                let label = ui.label(format!("joint − {name}"));
                words::explain_all(label, &[&glossary::JOINT, &glossary::INTER_PRISM]);
                for station in moved {
                    number_head(ui, &format!("T1{}", station.station), 8);
                    number_head(ui, "in σ", IN_SIGMA);
                }
                ui.end_row();
                let mm = |m: f64| format!("{:.2}", m * 1e3);
                difference_row(ui, "distance (mm)", moved.iter().map(|s| s.distance_m), mm);
                for (axis, name) in ["x (mm)", "y (mm)", "z (mm)"].into_iter().enumerate() {
                    let along = moved.iter().map(|station| station.translation_m[axis]);
                    difference_row(ui, name, along, |m| units.length_difference(m));
                }
                let yaw = format!("yaw ({})", units.angle.small_name());
                let turned = moved.iter().map(|station| station.yaw_rad);
                difference_row(ui, &yaw, turned, |rad| units.angle_difference(rad));
            });
    }
    ui.horizontal_wrapped(|ui| {
        let verdict = published.verdict_in_words();
        ui.label(format!("Verdict of {name}: {verdict}"));
        let button = ui
            .small_button(format!("Show the paper's {name}"))
            .on_hover_text("Selects this method; the same list has the joint estimate");
        if button.clicked() {
            let mut settings = *state.settings();
            settings.calibration.method = Some(published.method);
            commands.push(DeploymentCommand::Set(settings).into());
        }
    });
}
