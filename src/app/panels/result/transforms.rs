//! The two transforms as numbers.

use egui::RichText;

use crate::app::model::estimates::{Shown, column};
use crate::app::model::{AngleUnit, Units};
use crate::app::words;
use resect_core::calibration::Calibration;
use resect_report::glossary;
use resect_report::text;

/// The rows of both transforms, each number with its σ in the same unit.
pub fn table(ui: &mut egui::Ui, calibration: &Calibration, units: Units) {
    let cells = cells(calibration, units);
    egui::Grid::new("transforms").num_columns(2).spacing([10.0, 3.0]).striped(true).show(
        ui,
        |ui| {
            for station in 1..3 {
                let term = [&glossary::T12, &glossary::T13][station - 1];
                words::explain(ui.strong(term.name), term);
                if station == 1 {
                    words::explain(ui.weak("value ± 1 σ"), &glossary::SIGMA);
                }
                ui.end_row();
                for (axis, name) in ["x", "y", "z", "yaw"].into_iter().enumerate() {
                    let label = ui.label(format!("{name} of T1{}", station + 1));
                    if axis == 3 {
                        words::explain(label, &glossary::YAW);
                    }
                    let cell = ui.monospace(&cells[4 * (station - 1) + axis]);
                    if axis == 3 {
                        let yaw_rad = calibration.station1_from_station[station].yaw_rad();
                        cell.on_hover_text(all_units(yaw_rad));
                    }
                    ui.end_row();
                }
            }
        },
    );
}

/// (x, y, z, yaw) of station 2, then of station 3, as a column.
fn cells(calibration: &Calibration, units: Units) -> Vec<String> {
    let of = |station: usize| {
        let transform = &calibration.station1_from_station[station];
        let sigma = calibration.sigma.map(|sigma| sigma[station - 1]);
        let mut numbers: Vec<Shown> = (0..3)
            .map(|axis| {
                let sigma_m = sigma.map(|sigma| sigma.translation_m[axis]);
                units.length_estimate(transform.translation_m[axis], sigma_m)
            })
            .collect();
        numbers.push(units.angle_estimate(transform.yaw_rad(), sigma.map(|s| s.yaw_rad)));
        numbers
    };
    column(&(1..3).flat_map(of).collect::<Vec<_>>())
}

fn all_units(radians: f64) -> String {
    let show = |angle| Units { angle, ..Units::default() }.angle_with_unit(radians);
    AngleUnit::ALL.map(show).join("\n")
}

/// Folded away: few read them, and Copy has them with all digits.
pub fn matrices(ui: &mut egui::Ui, calibration: &Calibration) {
    ui.collapsing("4×4 matrices", |ui| {
        for station in 1..3 {
            ui.label(format!("T1{}, translation in m", station + 1));
            egui::ScrollArea::horizontal().id_salt(station).show(ui, |ui| {
                let text = text::matrix(calibration, station);
                let text = RichText::new(text.trim_end()).monospace().size(11.0);
                ui.add(egui::Label::new(text).extend());
            });
        }
    });
}
