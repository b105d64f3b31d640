//! The paper's two metrics of the result.

use egui::RichText;
use resect_core::network::{Number, Pair, PerStation, Prism};

use crate::app::panels::{heading, number_cell, number_head};
use crate::app::words;
use resect_core::deployment::ControlPointSet;
use resect_core::evaluation::{Evaluation, Spread};
use resect_report::glossary;

/// Name of the first metric: if all stations track one prism, the distances compare their versions of it.
pub fn name(followed: &PerStation<Prism>) -> &'static str {
    match Prism::is_one(followed) {
        true => "Same prism",
        false => "Inter-prism",
    }
}

/// Shows the metrics, always in mm because they are small.
pub fn ui(
    ui: &mut egui::Ui,
    evaluation: &Evaluation,
    followed: &PerStation<Prism>,
    sets: &[ControlPointSet],
) {
    heading(ui, "Metrics (mm)");
    egui::Grid::new("metrics").num_columns(4).spacing([10.0, 3.0]).striped(true).show(ui, |ui| {
        ui.label("");
        number_head(ui, "median", 7);
        words::explain(number_head(ui, "IQR", 7), &glossary::IQR);
        number_head(ui, "n", 6);
        ui.end_row();
        let row = |ui: &mut egui::Ui, name: RichText, term, spread: &Spread| {
            words::explain(ui.label(name), term);
            number_cell(ui, format!("{:.2}", spread.median), 7);
            number_cell(ui, format!("{:.2}", spread.iqr), 7);
            number_cell(ui, spread.n.to_string(), 6);
            ui.end_row();
        };
        let all = name(followed);
        let distances = &glossary::INTER_PRISM_METRIC;
        let each = if Prism::is_one(followed) { "stations" } else { "prisms" };
        if let Some(spread) = &evaluation.inter_prism_mm {
            row(ui, RichText::new(all).strong(), distances, spread);
        }
        for (pair, spread) in evaluation.inter_prism_by_pair_mm.iter().enumerate() {
            if let Some(spread) = spread {
                let name = format!("   {each} {}", Pair::at(pair));
                row(ui, RichText::new(name), distances, spread);
            }
        }
        if let Some(spread) = &evaluation.against_measured_mm {
            row(ui, RichText::new("   as measured"), distances, spread);
        }
        for metric in &evaluation.control_points_mm {
            // Files from other folders have full paths.
            row(ui, RichText::new(file_name(&metric.file)), &glossary::GCP_METRIC, &metric.spread);
        }
    });
    if followed.len() == 1 {
        ui.weak("One station: the metrics need two.");
    } else if evaluation.control_points_mm.is_empty() {
        ui.weak("No control points: no control-point metric.");
    }
    for set in sets.iter().filter(|set| set.pillars) {
        let name = file_name(&set.file);
        let line = format!("{name}: pillars, excluded from the metric as in the paper.");
        ui.add(egui::Label::new(RichText::new(line).weak()).wrap());
    }
}

fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}
