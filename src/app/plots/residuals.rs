//! Distance errors over time, one colour a pair, with the kept intervals behind and the time cursor.

use eframe::egui;
use egui_plot::{AxisHints, FilledArea, HoverPosition, Plot, PlotPoints, Points, Span, VLine};

use super::prepared::Band;
use super::{LABELS, answer, pair_switches, round_marks};
use crate::analysis::{Analysis, Answer};
use crate::app::open_deployment::OpenDeployment;
use crate::app::state::{Command, Commands, State};
use crate::app::theme;
use crate::deployment::pair_label;
use crate::palette;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let Some((open, analysis, answer)) = answer(state) else {
        ui.centered_and_justified(|ui| ui.weak("No result to plot."));
        return;
    };
    if state.is_stale() {
        ui.multiply_opacity(0.45);
    }
    let dark = ui.visuals().dark_mode;
    let start_s = open.start_s();
    let range_mm = open.plots.range_mm;
    let end_s = open.deployment.end_s().unwrap_or(start_s) - start_s;
    // The range of the last frame: shown in the caption, and kept while the settings change if the user chose it.
    let range_id = ui.scope_id().with(("shown range", open.id));
    let last: Option<ShownRange> = ui.data(|data| data.get_temp(range_id));
    let shown_mm = last.map_or(range_mm, |last| last.shown_mm);
    let follows = last.is_some_and(|last| last.is_default() && last.default_mm != range_mm);
    ui.horizontal(|ui| {
        ui.add_space(6.0);
        pair_switches(ui, state, commands);
        let text = caption(open, analysis, answer, shown_mm);
        ui.add(egui::Label::new(egui::RichText::new(text).small()).truncate());
    });
    let plot = Plot::new(("residuals", open.id))
        .custom_x_axes(vec![
            AxisHints::new_x().label("time since the first measurement (s)").label_spacing(LABELS),
        ])
        .y_axis_label("distance error (mm)")
        .x_grid_spacer(round_marks)
        .y_grid_spacer(round_marks)
        .default_x_bounds(0.0, end_s.max(1.0))
        .default_y_bounds(range_mm[0], range_mm[1])
        .label_formatter(|position| match position {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                Some(format!("{plot_name}\n{:.1} s\n{:+.2} mm", position.x, position.y))
            }
            HoverPosition::Elsewhere { .. } => None,
        });
    let response = plot.show(ui, |plot_ui| {
        if follows {
            plot_ui.set_plot_bounds_y(range_mm[0]..=range_mm[1]);
        }
        let shade = ui_shade(dark);
        for interval in analysis.pipeline.kept_intervals.iter() {
            plot_ui.span(
                Span::new("", interval.start_s - start_s..=interval.end_s - start_s).fill(shade),
            );
        }
        if state.visibility.uncertainty {
            for (pair, bands) in open.plots.bands.iter().enumerate() {
                if !state.visibility.pairs[pair] {
                    continue;
                }
                let fill = theme::rgb(palette::PAIRS[pair]).gamma_multiply(0.16);
                for Band { times_s, half_widths_mm } in bands {
                    let lower: Vec<f64> = half_widths_mm.iter().map(|w| -w).collect();
                    let area = FilledArea::new("", times_s, &lower, half_widths_mm);
                    plot_ui.add(area.fill_color(fill).allow_hover(false));
                }
            }
        }
        for (pair, dots) in open.plots.dots.iter().enumerate() {
            if !state.visibility.pairs[pair] {
                continue;
            }
            plot_ui.points(
                Points::new(format!("prisms {}", pair_label(pair)), PlotPoints::Borrowed(dots))
                    .color(theme::rgb(palette::PAIRS[pair]))
                    .radius(1.4),
            );
        }
        if let Some(cursor_s) = open.timeline.cursor_s {
            let colour = theme::rgb(theme::cursor(dark));
            plot_ui.vline(VLine::new("", cursor_s - start_s).color(colour).width(1.0));
        }
    });
    if response.response.clicked()
        && let Some(at) = response.response.interact_pointer_pos()
    {
        commands.push(Command::MoveCursor(response.transform.value_from_position(at).x + start_s));
    }
    let bounds = response.transform.bounds();
    let shown_mm = [bounds.min()[1], bounds.max()[1]];
    ui.data_mut(|data| data.insert_temp(range_id, ShownRange { shown_mm, default_mm: range_mm }));
}

fn ui_shade(dark: bool) -> egui::Color32 {
    if dark { egui::Color32::from_white_alpha(7) } else { egui::Color32::from_black_alpha(9) }
}

/// What the plot showed in the last frame, and what it would show untouched.
#[derive(Clone, Copy)]
struct ShownRange {
    shown_mm: [f64; 2],
    default_mm: [f64; 2],
}

impl ShownRange {
    fn is_default(&self) -> bool {
        let [low, high] = self.default_mm;
        (self.shown_mm[0] - low).abs() + (self.shown_mm[1] - high).abs() < 1e-6 * (high - low)
    }
}

/// The errors at the cursor, and how many lie outside what is shown: nothing is hidden without a word.
fn caption(
    open: &OpenDeployment,
    analysis: &Analysis,
    answer: &Answer,
    shown_mm: [f64; 2],
) -> String {
    let errors = || answer.evaluation.distance_errors_mm.iter().flatten();
    let outside = errors().filter(|e| **e < shown_mm[0] || **e > shown_mm[1]).count();
    let mut parts = Vec::new();
    if let Some(cursor_s) = open.timeline.cursor_s {
        let at = cursor_s - open.start_s();
        parts.push(match analysis.triplets().nearest(cursor_s) {
            Some(index) => {
                let [a, b, c] = answer.evaluation.distance_errors_mm.each_ref().map(|e| e[index]);
                format!("at {at:.1} s  {a:+.1}, {b:+.1}, {c:+.1} mm")
            }
            None => format!("at {at:.1} s  in no interval"),
        });
    }
    if open.plots.bands.iter().any(|bands| !bands.is_empty()) {
        parts.push("bands: ±2σ that the interpolation states".to_owned());
    }
    if outside > 0 {
        parts.push(format!(
            "{outside} of {} beyond the range (double-click: all)",
            errors().count()
        ));
    }
    parts.join("  ·  ")
}
