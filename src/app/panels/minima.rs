//! Lists every minimum of the cost that the search found, folded under the mirror twin.

use crate::app::model::Units;
use crate::app::panels::{number_cell, number_head};
use crate::app::words;
use resect_core::calibration::inter_prism::InterPrismDetails;
use resect_report::glossary;

pub fn ui(ui: &mut egui::Ui, details: &InterPrismDetails, units: Units) {
    let title = format!("minima ({})", details.basins.len());
    let header = egui::CollapsingHeader::new(title).id_salt("minima").show(ui, |ui| {
        egui::Grid::new("minima").num_columns(4).spacing([10.0, 2.0]).striped(true).show(
            ui,
            |ui| {
                ui.label("");
                for name in ["RMS (mm)", "cost ratio", "away (m)"] {
                    words::explain_text(number_head(ui, name, name.len()), name);
                }
                ui.end_row();
                for basin in &details.basins {
                    let transforms = basin.station1_from_station.each().skip(1);
                    let lines = transforms.map(|(station, t)| {
                        let [x, y, z] = <[f64; 3]>::from(t.translation_m).map(|m| units.length(m));
                        let (length, yaw) = (units.length.name(), units.angle_with_unit(t.yaw_rad));
                        format!("T1{station}  {x}  {y}  {z} {length}, yaw {yaw}")
                    });
                    let lines: Vec<String> = lines.collect();
                    ui.label(details.role(basin)).on_hover_text(lines.join("\n"));
                    let rms_mm = basin.mean_square_m2.sqrt() * 1e3;
                    number_cell(ui, format!("{rms_mm:.2}"), 8);
                    number_cell(ui, format!("{:.2}", details.cost_ratio(basin)), 10);
                    number_cell(ui, format!("{:.2}", basin.apart_m(&details.basin)), 8);
                    ui.end_row();
                }
            },
        );
        ui.small("Away: distance of a station from its position in the result.");
    });
    words::explain(header.header_response, &glossary::MINIMUM);
}
