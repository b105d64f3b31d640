//! The two transforms as numbers.

use crate::app::panels::number_cell;

use crate::app::model::estimates::column;
use crate::app::model::units::without_negative_zero;
use crate::app::model::{AngleUnit, Units};
use crate::app::words;
use resect_core::calibration::{Calibration, Quantity};
use resect_core::evaluation::answer_rows::{AnswerRow, RowGroup};
use resect_report::glossary;

/// Shows the rows of both transforms, each number with its σ in the same unit.
pub fn table(ui: &mut egui::Ui, rows: &[AnswerRow], units: Units) {
    let rows: Vec<&AnswerRow> =
        rows.iter().filter(|row| row.group == RowGroup::Transforms).collect();
    let cells = column(&rows.iter().map(|row| units.value(row)).collect::<Vec<_>>());
    let grid = egui::Grid::new("transforms").num_columns(2).spacing([10.0, 3.0]).striped(true);
    grid.show(ui, |ui| {
        let mut subject = "";
        for (index, (row, cell)) in rows.iter().zip(cells).enumerate() {
            if row.subject != subject {
                subject = &row.subject;
                words::explain_text(ui.strong(subject), subject);
                if index == 0 {
                    words::explain(ui.weak("value ± 1 σ"), &glossary::SIGMA);
                }
                ui.end_row();
            }
            let label = ui.label(format!("{} of {}", row.name, row.subject));
            if row.name == "yaw" {
                words::explain(label, &glossary::YAW);
            }
            let cell = ui.monospace(cell);
            if row.quantity == Quantity::Angle {
                cell.on_hover_text(all_units(row.value));
            }
            ui.end_row();
        }
    });
}

fn all_units(radians: f64) -> String {
    let show = |angle| Units { angle, ..Units::default() }.angle_with_unit(radians);
    AngleUnit::ALL.map(show).join("\n")
}

/// Width of a number of a matrix (figures).
const MATRIX_FIGURES: usize = 9;

/// Shows the matrices, folded because few read them; Copy gives all digits.
pub fn matrices(ui: &mut egui::Ui, calibration: &Calibration) {
    ui.collapsing("4×4 matrices", |ui| {
        for (station, transform) in calibration.station1_from_station.each().skip(1) {
            ui.label(format!("T1{station}, translation in m"));
            let matrix = transform.matrix();
            egui::Grid::new(("matrix", station)).spacing([2.0, 1.0]).show(ui, |ui| {
                for row in 0..4 {
                    for column in 0..4 {
                        let number = without_negative_zero(matrix[(row, column)], 6);
                        number_cell(ui, number, MATRIX_FIGURES);
                    }
                    ui.end_row();
                }
            });
        }
    });
}
