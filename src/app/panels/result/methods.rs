//! Details by method: the mirror twin of D, the pairs of A, the frame of B.

use crate::app::model::Units;
use crate::app::panels::{heading, minima, number_cell, number_head, observability};
use crate::app::words;
use resect_core::calibration::inter_prism::InterPrismDetails;
use resect_core::calibration::static_gcp::StaticGcpDetails;
use resect_core::calibration::two_point::TwoPointDetails;
use resect_core::calibration::{Calibration, Details, Mirror, ResolvedBy};
use resect_report::glossary;

pub fn ui(ui: &mut egui::Ui, calibration: &Calibration, units: Units) {
    match &calibration.details {
        Details::TwoPoint(details) => two_point(ui, details, units),
        Details::StaticGcp(details) => static_gcp(ui, details, units),
        Details::DynamicGcp(_) | Details::InterPrism(_) | Details::Joint(_) => {}
    }
    if let Some(details) = calibration.inter_prism() {
        mirror(ui, details, units);
        minima::ui(ui, details, units);
        observability::ui(ui, &details.observability);
    }
}

fn mirror(ui: &mut egui::Ui, details: &InterPrismDetails, units: Units) {
    let Mirror { twin, cost_ratio, resolved_by } = &details.mirror;
    heading(ui, "Mirrored solution");
    let (Some(twin), Some(ratio)) = (twin, cost_ratio) else {
        ui.label("None: pitch and roll exclude a second minimum.");
        return;
    };
    let by = match resolved_by {
        ResolvedBy::Rig => "resolved by the rig's heights",
        ResolvedBy::ControlPoints => "resolved by control points",
        ResolvedBy::Cost => "resolved by cost",
        ResolvedBy::Likelihood => "resolved by all readings",
        ResolvedBy::Nothing => "not resolved",
    };
    egui::Grid::new("mirror").num_columns(3).spacing([10.0, 2.0]).show(ui, |ui| {
        ui.label("");
        number_head(ui, "result", 8);
        number_head(ui, "mirrored", 8);
        ui.end_row();
        for station in details.basin.station1_from_station.numbers().skip(1) {
            ui.label(format!("z of T1{station} ({})", units.length.name()));
            for basin in [&details.basin, twin] {
                let z_m = basin.station1_from_station[station].translation_m.z;
                number_cell(ui, units.length(z_m), 8);
            }
            ui.end_row();
        }
        ui.label("RMS error (mm)");
        for basin in [&details.basin, twin] {
            number_cell(ui, format!("{:.2}", basin.mean_square_m2.sqrt() * 1e3), 8);
        }
        ui.end_row();
        words::explain(ui.label("cost ratio"), &glossary::COST_RATIO);
        number_cell(ui, "1.00", 8);
        number_cell(ui, format!("{ratio:.2}"), 8);
        ui.end_row();
    });
    ui.label(format!("Ambiguity {by}."));
}

/// Shows every pair of known points, with the errors at the points left out.
fn two_point(ui: &mut egui::Ui, details: &TwoPointDetails, units: Units) {
    heading(ui, "Pairs of known points");
    let widest =
        |values: &[f64]| values.last().map_or("–".to_owned(), |m| format!("{:.1}", m * 1e3));
    egui::Grid::new("pairs").num_columns(4).spacing([10.0, 2.0]).striped(true).show(ui, |ui| {
        ui.label("points").on_hover_text("Markers of the two points");
        let apart = format!("apart ({})", units.length.name());
        let heads = [
            (apart.as_str(), "Known distance between them"),
            (
                "left out (mm)",
                "Largest distance between the stations' positions of a point left out",
            ),
            (
                "known (mm)",
                "Largest distance of a point left out from its known position, mean of the stations",
            ),
        ];
        for (name, hint) in heads {
            number_head(ui, name, name.len()).on_hover_text(hint);
        }
        ui.end_row();
        for (index, pair) in details.pairs.iter().enumerate() {
            let chosen = if index == details.chosen { " →" } else { "" };
            let name = format!("{}–{}{chosen}", pair.markers[0], pair.markers[1]);
            let known =
                pair.largest_from_known_m().map_or("–".to_owned(), |m| format!("{:.1}", m * 1e3));
            let numbers = [units.length(pair.baseline_m), widest(&pair.left_out_m), known];
            ui.label(name);
            for (number, (head, _)) in numbers.into_iter().zip(heads) {
                number_cell(ui, number, head.len());
            }
            ui.end_row();
        }
    });
    ui.small("→ the pair that the result uses");
}

fn static_gcp(ui: &mut egui::Ui, details: &StaticGcpDetails, units: Units) {
    if let Some(world) = &details.world_from_station1 {
        heading(ui, "Station 1 in the points' frame");
        let [x, y, z] = <[f64; 3]>::from(world.translation_m).map(|value| units.length(value));
        ui.monospace(format!("{x}  {y}  {z} {}", units.length.name()));
        ui.monospace(format!("yaw {}", units.angle_with_unit(world.yaw_rad())));
    }
}
