//! How the distance errors are distributed, one outline a pair.

use eframe::egui;
use egui_plot::{AxisHints, Line, Plot, PlotPoints, VLine};

use super::{LABELS, answer, pair_name, round_marks};
use crate::app::state::State;
use crate::app::theme;
use crate::deployment::pair_label;
use crate::palette;

pub fn ui(ui: &mut egui::Ui, state: &State) {
    let Some((open, ..)) = answer(state) else {
        ui.centered_and_justified(|ui| ui.weak("No result to plot."));
        return;
    };
    if state.is_stale() {
        ui.multiply_opacity(0.45);
    }
    let plots = &open.plots;
    let ([low, high], width) = (plots.range_mm, plots.bin_width_mm);
    ui.horizontal(|ui| {
        ui.add_space(6.0);
        ui.label("prisms");
        for pair in (0..3).filter(|pair| state.visibility.pairs[*pair]) {
            ui.label(pair_name(pair, ui.visuals().dark_mode));
        }
    });
    // The highest number of the axis reaches above it.
    ui.add_space(4.0);
    let zero_colour = theme::faint(ui.visuals().dark_mode);
    Plot::new(("histogram", open.id, open.analysis_run))
        .custom_x_axes(vec![AxisHints::new_x().label("error (mm)").label_spacing(LABELS)])
        .x_grid_spacer(round_marks)
        .y_grid_spacer(round_marks)
        .y_axis_label(format!("triplets per {width:.2} mm"))
        .default_x_bounds(low, high)
        .default_y_bounds(0.0, plots.highest_count as f64 * 1.08)
        .allow_scroll(false)
        .show(ui, |plot_ui| {
            plot_ui.vline(VLine::new("", 0.0).color(zero_colour).width(0.8));
            for (pair, outline) in plots.outlines.iter().enumerate() {
                if !state.visibility.pairs[pair] {
                    continue;
                }
                plot_ui.line(
                    Line::new(
                        format!("prisms {}", pair_label(pair)),
                        PlotPoints::Borrowed(outline),
                    )
                    .color(theme::rgb(palette::PAIRS[pair]))
                    .width(1.2)
                    .allow_band(false)
                    .fill(0.0)
                    .fill_alpha(0.12),
                );
            }
        });
}
