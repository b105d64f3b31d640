//! Correlations of the numbers of the transforms as a table, shaded by size.

use egui::{Align2, Color32, FontId, Rect, Sense, Vec2};
use nalgebra::DMatrix;

use crate::app::theme;
use crate::app::words;
use resect_report::glossary;
use resect_tools::palette;

const NAMES: [&str; 4] = ["x", "y", "z", "ψ"];
const HEAD: f32 = 26.0;
const ROW: f32 = 19.0;
const WIDEST_CELL: f32 = 44.0;

/// Shows the correlations of x, y, z and yaw of stations 2, 3, …, on request.
pub fn ui(ui: &mut egui::Ui, correlation: &DMatrix<f64>) {
    let count = correlation.nrows();
    let shown = ui.collapsing("Correlations", |ui| {
        let cell = ((ui.available_width() - HEAD) / count as f32).min(WIDEST_CELL);
        let size = Vec2::new(HEAD + count as f32 * cell, (count + 1) as f32 * ROW);
        let (whole, response) = ui.allocate_exact_size(size, Sense::hover());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Correlations"));
        let dark = ui.visuals().dark_mode;
        let ink = ui.visuals().text_color();
        let font = FontId::proportional(11.0);
        let place = |row: usize, column: usize| {
            let corner = whole.min + Vec2::new(HEAD + column as f32 * cell, (row + 1) as f32 * ROW);
            Rect::from_min_size(corner, Vec2::new(cell, ROW)).shrink(0.5)
        };
        let painter = ui.painter();
        for index in 0..count {
            let name = format!("{}{}", NAMES[index % 4], index / 4 + 2);
            let above = place(0, index).center() - Vec2::new(0.0, ROW);
            painter.text(above, Align2::CENTER_CENTER, &name, font.clone(), ink);
            let beside = egui::pos2(whole.left() + HEAD / 2.0, place(index, 0).center().y);
            painter.text(beside, Align2::CENTER_CENTER, name, font.clone(), ink);
            for column in 0..count {
                let value = correlation[(index, column)];
                let place = place(index, column);
                painter.rect_filled(place, 0.0, shade(value, dark));
                let text = format!("{value:+.2}");
                painter.text(place.center(), Align2::CENTER_CENTER, text, font.clone(), ink);
            }
        }
        ui.small(
            "At the stations: x, y, z and yaw ψ of T12, T13, …. Near ±1, the data do not separate the two. \
             Vermilion: positive correlation; blue: negative.",
        );
    });
    words::explain(shown.header_response, &glossary::CORRELATION);
}

/// Returns a colour that is stronger for a larger correlation; the background colour for zero.
fn shade(value: f64, dark: bool) -> Color32 {
    let colour = theme::rgb(palette::correlation(value));
    theme::scene_background(dark).lerp_to_gamma(colour, 0.7 * value.abs() as f32)
}
