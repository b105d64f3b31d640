//! Validation of the active deployment's calibration on the other open ones: a verdict and a test for each station.

use egui::RichText;

use super::{finding, heading};
use crate::app::model::{Commands, ResultsCommand, Units};
use crate::app::state::State;
use crate::app::theme;
use crate::app::words;
use resect_report::glossary;
use resect_tools::palette;
use resect_tools::validation::in_words::chance;
use resect_tools::validation::{Difference, Validation};

/// Shows the validations if another deployment is open. Sentences wrap at this width (points).
pub fn ui(ui: &mut egui::Ui, state: &State, width: f32, commands: &mut Commands) {
    let Some(active) = state.active().filter(|_| state.deployments.open.len() > 1) else { return };
    heading(ui, "The same set-up?");
    ui.horizontal(|ui| {
        let name = state.name_of(active.id).unwrap_or_default();
        let text = format!("Apply {name}'s calibration to the others");
        let button = ui
            .add_enabled(state.can_validate(), egui::Button::new(text))
            .on_hover_text(
                "Tests if it is still valid there: the metric, and any station that moved since",
            )
            .on_disabled_hover_text("Available after the calibration");
        if button.clicked() {
            commands.push(ResultsCommand::ValidateOthers.into());
        }
        if let Some((_, progress)) = &state.results.validations.running {
            ui.spinner();
            if ui.button("Cancel").clicked() {
                progress.cancel();
            }
        }
    });
    for (index, (name, found)) in state.validated().enumerate() {
        ui.add_space(4.0);
        ui.scope(|ui| {
            ui.set_max_width(width);
            one(ui, state, &name, (index, found), commands);
        });
    }
    ui.add_space(6.0);
    ui.separator();
}

fn one(
    ui: &mut egui::Ui,
    state: &State,
    name: &str,
    (index, found): (usize, &Validation),
    commands: &mut Commands,
) {
    ui.horizontal(|ui| {
        let [ground, ink] = palette::outcome(&found.outcome).map(theme::rgb);
        let word = RichText::new(format!(" {} ", found.outcome.name()));
        ui.label(word.color(ink).background_color(ground));
        ui.strong(format!("for {name}"));
    });
    ui.add(egui::Label::new(found.why_with(&|angle| state.workspace.units.told(angle))).wrap());
    if let Some(difference) = &found.difference {
        stations(ui, (index, difference), state.workspace.units);
    }
    if let Some(metric) = &found.metric {
        ui.monospace(format!(
            "inter-prism median / IQR (mm): applied {:.2} / {:.2}, own {:.2} / {:.2}",
            metric.earlier_mm.median,
            metric.earlier_mm.iqr,
            metric.own_mm.median,
            metric.own_mm.iqr
        ));
    }
    found.caveats.iter().for_each(|caveat| finding(ui, state, caveat, commands));
}

/// Shows the motion of each station under the assumption that no other station moved.
fn stations(ui: &mut egui::Ui, (index, difference): (usize, &Difference), units: Units) {
    let small = units.angle.small_name();
    egui::Grid::new(("validation", index)).num_columns(8).spacing([12.0, 3.0]).striped(true).show(
        ui,
        |ui| {
            ui.label("if only it moved");
            for name in ["x (mm)", "y (mm)", "z (mm)", &format!("turn ({small})")] {
                ui.label(name);
            }
            for name in ["not moved", "moved alone"] {
                words::explain(ui.label(name), &glossary::VALIDATION);
            }
            ui.end_row();
            for (station, moved) in difference.stations.iter().enumerate() {
                ui.strong(format!("station {}", station + 1));
                for part in [0, 1, 2].map(|axis| moved.part(axis)) {
                    let (by, sigma) =
                        (units.length_difference(part.value), units.length_sigma(Some(part.sigma)));
                    ui.monospace(format!("{by:>8} ± {sigma}"));
                }
                let turned = moved.turned_rad();
                let (by, sigma) =
                    (units.angle_difference(turned.value), units.angle_sigma(Some(turned.sigma)));
                ui.monospace(format!("{by:>8} ± {sigma}"));
                ui.monospace(chance(moved.p_value));
                ui.monospace(chance(moved.rest_p_value));
                ui.label(moved.verdict());
                ui.end_row();
            }
        },
    );
}
