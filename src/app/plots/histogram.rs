//! How the distance errors are distributed, one outline a pair.

use eframe::egui;
use egui_plot::{AxisHints, Line, Plot, PlotPoints, VLine};

use super::{answer, half_range_mm, pair_name};
use crate::app::state::State;
use crate::app::theme;
use crate::deployment::pair_label;
use crate::palette;

const BINS: usize = 40;

pub fn ui(ui: &mut egui::Ui, state: &State) {
    let Some((_, answer)) = answer(state) else {
        ui.centered_and_justified(|ui| ui.weak("No result to plot."));
        return;
    };
    if state.is_stale() {
        ui.multiply_opacity(0.45);
    }
    let half_range = half_range_mm(answer);
    let width = 2.0 * half_range / BINS as f64;
    let counts = answer.evaluation.distance_errors_mm.each_ref().map(|e| bins(e, half_range));
    let highest = counts.iter().flatten().copied().max().unwrap_or(1).max(1);
    ui.horizontal(|ui| {
        ui.add_space(6.0);
        ui.label("prisms");
        for pair in (0..3).filter(|pair| state.visibility.pairs[*pair]) {
            ui.label(pair_name(pair, ui.visuals().dark_mode));
        }
    });
    let zero_colour = theme::faint(ui.visuals().dark_mode);
    Plot::new(("histogram", state.deployment_number, state.analysis_run))
        .custom_x_axes(vec![
            AxisHints::new_x().label("distance error (mm)").label_spacing(20.0..=40.0),
        ])
        .y_axis_label(format!("triplets per {width:.2} mm"))
        .default_x_bounds(-half_range, half_range)
        .default_y_bounds(0.0, highest as f64 * 1.08)
        .allow_scroll(false)
        .show(ui, |plot_ui| {
            plot_ui.vline(VLine::new("", 0.0).color(zero_colour).width(0.8));
            for (pair, counts) in counts.iter().enumerate() {
                if !state.visibility.pairs[pair] {
                    continue;
                }
                let outline: PlotPoints<'_> = counts
                    .iter()
                    .enumerate()
                    .flat_map(|(bin, count)| {
                        let left = -half_range + bin as f64 * width;
                        [[left, *count as f64], [left + width, *count as f64]]
                    })
                    .collect();
                plot_ui.line(
                    Line::new(format!("prisms {}", pair_label(pair)), outline)
                        .color(theme::rgb(palette::PAIRS[pair]))
                        .width(1.2)
                        .allow_band(false)
                        .fill(0.0)
                        .fill_alpha(0.12),
                );
            }
        });
}

/// Counts in equal bins over ± the range; what lies beyond is not counted.
fn bins(errors: &[f64], half_range: f64) -> Vec<usize> {
    let mut counts = vec![0; BINS];
    for error in errors {
        let at = (error + half_range) / (2.0 * half_range) * BINS as f64;
        if at >= 0.0 && at < BINS as f64 {
            counts[at as usize] += 1;
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_within_the_range_is_counted_once() {
        let counts = bins(&[-0.999, -0.2, 0.0, 0.5, 0.999, 3.0], 1.0);
        assert_eq!(counts.iter().sum::<usize>(), 5);
        assert_eq!((counts[0], counts[BINS - 1]), (1, 1));
    }
}
