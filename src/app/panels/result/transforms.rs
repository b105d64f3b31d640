//! The two transforms as numbers.

use eframe::egui::{self, RichText};

use crate::app::model::{AngleUnit, Units};
use crate::app::words;
use crate::calibration::Calibration;
use crate::export::text;
use crate::glossary;

/// A column for each transform: value ± σ.
pub fn table(ui: &mut egui::Ui, calibration: &Calibration, units: Units) {
    let [length, angle] = [units.length.name(), units.angle.name()];
    egui::Grid::new("transforms").num_columns(5).spacing([7.0, 3.0]).striped(true).show(ui, |ui| {
        ui.label("");
        for (station, term) in [(1, &glossary::T12), (2, &glossary::T13)] {
            words::explain(ui.strong(format!("T1{}", station + 1)), term);
            words::explain(ui.weak("± 1 σ"), &glossary::SIGMA);
        }
        ui.end_row();
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            ui.label(format!("{name} ({length})"));
            for station in 1..3 {
                let value = calibration.station1_from_station[station].translation_m[axis];
                let sigma = calibration.sigma.map(|s| s[station - 1].translation_m[axis]);
                ui.monospace(format!("{:>9}", units.length(value)));
                ui.monospace(format!("± {}", units.length_sigma(sigma)));
            }
            ui.end_row();
        }
        words::explain(ui.label(format!("yaw ({angle})")), &glossary::YAW);
        for station in 1..3 {
            let value = calibration.station1_from_station[station].yaw_rad();
            let sigma = calibration.sigma.map(|s| s[station - 1].yaw_rad);
            ui.monospace(format!("{:>9}", units.angle(value))).on_hover_text(all_units(value));
            ui.monospace(format!("± {}", units.angle_sigma(sigma)));
        }
        ui.end_row();
    });
    ui.small(format!(
        "± one standard deviation: mm for lengths, {} for the yaw",
        units.angle.small_name()
    ));
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
