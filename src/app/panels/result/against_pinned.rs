//! Changes against a pinned result: transforms, metrics, settings.

use egui::RichText;

use super::difference_row::{BESIDE, IN_SIGMA, difference_row};
use crate::app::model::{Commands, OpenDeployment, Pin, ResultsCommand, Units};
use crate::app::panels::{heading, number_cell, number_head, use_pinned};
use crate::app::state::State;
use crate::app::theme;
use resect_core::calibration::moved_m;
use resect_core::deployment::{Deployment, Severity};
use resect_core::evaluation::Spread;
use resect_report::difference::{
    Compared, Deviation, EstimateDifference, ResultDifference, StationDifference,
};
use resect_report::summary::ResultSummary;

/// Shows the differences from the pinned result, if there is one.
pub fn ui(ui: &mut egui::Ui, state: &State, open: &OpenDeployment, commands: &mut Commands) {
    let (Some(pin), Some(now)) = (state.compared_with(), &open.summary) else { return };
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        ui.strong(format!("Compared with pinned result {}", pin.name));
        if ui.small_button(format!("Unpin {}", pin.name)).clicked() {
            commands.push(ResultsCommand::Unpin(pin.id).into());
        }
        use_pinned(ui, state, pin.id, commands);
    });
    if *pin.summary == **now {
        ui.weak("This is the pinned result.");
        return;
    }
    let difference = ResultDifference::between(&pin.summary, now);
    if !difference.same_data {
        let (colour, sign) = theme::severity(Severity::Warning, ui.visuals().dark_mode);
        let text = format!(
            "{sign} {} is other data: its stations may have stood elsewhere.",
            state.name_of_result(&pin.summary)
        );
        ui.label(RichText::new(text).color(colour));
    }
    verdict_and_settings(ui, &difference, state.workspace.units);
    transforms(ui, &difference, (pin, now, &open.deployment), state.workspace.units);
    estimates(ui, &difference, state.workspace.units);
    metrics(ui, &difference);
}

/// Shows the estimates other than the transforms that are significant in one of the two results.
fn estimates(ui: &mut egui::Ui, difference: &ResultDifference, units: Units) {
    if difference.estimates.is_empty() {
        return;
    }
    heading(ui, "Other estimates");
    let grid = egui::Grid::new("estimates against pinned").num_columns(4).spacing([10.0, 3.0]);
    grid.striped(true).show(ui, |ui| {
        for name in ["", "pinned", "now", "in σ"] {
            ui.label(name);
        }
        ui.end_row();
        for EstimateDifference { rows, deviation } in &difference.estimates {
            ui.label(format!("{}, {}", rows.now.subject, rows.now.name));
            for row in [&rows.pinned, &rows.now] {
                ui.monospace(units.deviation(row).in_words());
            }
            ui.monospace(deviation.sigmas.map_or("–".to_owned(), |sigmas| format!("{sigmas:.1}")));
            ui.end_row();
        }
    });
}

fn verdict_and_settings(ui: &mut egui::Ui, difference: &ResultDifference, units: Units) {
    let Compared { pinned, now } = difference.verdict;
    if pinned != now {
        ui.label(format!("verdict {} → {}", pinned.name(), now.name()));
    }
    let Compared { pinned, now } = difference.method;
    if pinned != now {
        ui.label(format!("method {} → {}", pinned.short_name(), now.short_name()));
    }
    if difference.settings.is_empty() {
        ui.weak("The settings are the same.");
    }
    for change in &difference.settings {
        ui.label(units.change(change.clone()).to_string());
    }
}

/// Shows the differences of the transforms, now minus pinned, each also in σ.
fn transforms(
    ui: &mut egui::Ui,
    difference: &ResultDifference,
    (pin, now, deployment): (&Pin, &ResultSummary, &Deployment),
    units: Units,
) {
    let length = |m: f64| units.length_difference(m);
    let angle = |rad: f64| units.angle_difference(rad);
    for (part, stations) in difference.stations.chunks(BESIDE).enumerate() {
        egui::Grid::new(("against pinned", part))
            .num_columns(1 + 2 * stations.len())
            .spacing([7.0, 3.0])
            .striped(true)
            .show(ui, |ui| {
                ui.label("now − pinned");
                for station in stations {
                    number_head(ui, &format!("T1{}", station.station), 8);
                    number_head(ui, "in σ", IN_SIGMA);
                }
                ui.end_row();
                for (axis, name) in ["x (mm)", "y (mm)", "z (mm)"].into_iter().enumerate() {
                    difference_row(
                        ui,
                        name,
                        stations.iter().map(|s| s.translation_m[axis]),
                        length,
                    );
                }
                difference_row(ui, "distance (mm)", stations.iter().map(|s| s.distance_m), |m| {
                    format!("{:.2}", m * 1e3)
                });
                let small = units.angle.small_name();
                difference_row(
                    ui,
                    &format!("yaw ({small})"),
                    stations.iter().map(|s| s.yaw_rad),
                    angle,
                );
                // For levelled results, the whole angle equals the yaw.
                if stations.iter().any(tilted) {
                    let whole =
                        stations.iter().map(|s| Deviation { value: s.angle_rad, sigmas: None });
                    difference_row(ui, &format!("total angle ({small})"), whole, angle);
                }
                if difference.same_data {
                    let moved = (0..stations.len()).map(|k| BESIDE * part + k).map(|k| {
                        let [before, after] =
                            [&*pin.summary, now].map(|s| s.stations[k].station1_from_station());
                        let value = moved_m(deployment, k + 1, &before, &after);
                        Deviation { value, sigmas: None }
                    });
                    difference_row(ui, "on its track (mm)", moved, |m| format!("{:.2}", m * 1e3));
                }
            });
    }
    ui.small(if difference.same_data {
        "In σ of the present result. Both use the same readings, so a difference below 1 σ does not matter. \
         On its track: RMS shift of the station's readings."
    } else {
        "In σ of both results combined."
    });
}

/// Returns true if the two differ by more than a yaw.
fn tilted(station: &StationDifference) -> bool {
    (station.angle_rad - station.yaw_rad.value.abs()).abs() > 1e-7
}

fn metrics(ui: &mut egui::Ui, difference: &ResultDifference) {
    heading(ui, "Median / IQR (mm)");
    egui::Grid::new("metrics against pinned")
        .num_columns(3)
        .spacing([10.0, 3.0])
        .striped(true)
        .show(ui, |ui| {
            for name in ["", "pinned", "now"] {
                ui.label(name);
            }
            ui.end_row();
            let row = |ui: &mut egui::Ui, name: &str, both: &Compared<Option<Spread>>| {
                ui.label(name);
                for spread in [&both.pinned, &both.now] {
                    let text = spread
                        .as_ref()
                        .map_or("–".to_owned(), |s| format!("{:.2} / {:.2}", s.median, s.iqr));
                    number_cell(ui, text, 13);
                }
                ui.end_row();
            };
            row(ui, "inter-prism", &difference.inter_prism_mm);
            for (file, both) in &difference.control_points_mm {
                row(ui, file, both);
            }
            ui.label("triplets");
            for count in [difference.triplets.pinned, difference.triplets.now] {
                number_cell(ui, count.to_string(), 13);
            }
            ui.end_row();
        });
}
