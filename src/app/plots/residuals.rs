//! Distance errors over time, one colour a pair, with the kept intervals behind and the time cursor.

use eframe::egui;
use egui_plot::{FilledArea, HoverPosition, MarkerShape, Plot, PlotPoints, PlotUi, Points, Span};

use super::navigation::Moved;
use super::time_plot::{self, time_axis};
use super::times::Times;
use super::{answer, pair_switches, round_marks};
use crate::analysis::{Analysis, Answer};
use crate::app::model::{Commands, OpenDeployment, Pin, Visibility};
use crate::app::prepared::gaps;
use crate::app::prepared::plots::{Band, PreparedPlots};
use crate::app::state::State;
use crate::app::theme;
use crate::app::words;
use crate::deployment::pair_label;
use crate::glossary;
use crate::palette;

/// Three times as many dots a pair are all drawn, also where the plot is narrow: of a cloud the eye wants more than the edges.
const LEAST_RUNS: usize = 1050;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let Some((open, analysis, answer)) = answer(state) else {
        ui.centered_and_justified(|ui| ui.weak("No result to plot."));
        return;
    };
    if state.is_stale() {
        ui.multiply_opacity(0.45);
    }
    let times = Times::of(open, state);
    // Errors that the user chose to see; otherwise the plot follows the answer.
    let chosen_id = ui.scope_id().with(("chosen errors", open.id));
    let chosen_mm: Option<[f64; 2]> = ui.data(|data| data.get_temp(chosen_id)).unwrap_or_default();
    let shown_mm = chosen_mm.unwrap_or(open.plots.range_mm);
    time_plot::head(ui, |ui| {
        pair_switches(ui, state, commands);
        for (pin, shape) in pinned(open, state) {
            let text = format!("{} {}", sign(shape), pin.name);
            ui.small(text).on_hover_text("A pinned result, behind the present one");
        }
        time_plot::selection(ui, &times, commands);
        let text = caption(open, analysis, answer, shown_mm);
        let label = egui::Label::new(egui::RichText::new(text).small()).truncate();
        words::explain(ui.add(label), &glossary::INTER_PRISM_METRIC);
        time_plot::hint(ui, " · ctrl+scroll: zoom in mm");
    });
    let plot = Plot::new(("residuals", open.id))
        .custom_x_axes(vec![time_axis(ui.available_width())])
        .y_axis_label("distance error (mm)")
        .y_grid_spacer(round_marks)
        .label_formatter(|position| match position {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                Some(format!("{plot_name}\n{:.1} s\n{:+.2} mm", position.x, position.y))
            }
            HoverPosition::Elsewhere { .. } => None,
        });
    let (plots, visibility) = (&open.plots, &state.visibility);
    let columns = ui.available_width() as usize;
    let shade = ui_shade(ui.visuals().dark_mode);
    let pinned = pinned(open, state);
    let name = "distance errors over time";
    let shown = time_plot::show(ui, name, &times, plot, shown_mm, commands, |plot_ui| {
        let s_per_column = (times.window_s[1] - times.window_s[0]) / columns.max(1) as f64;
        for seen in gaps::visible(&plots.gaps.kept, times.window_s, s_per_column) {
            plot_ui.span(Span::new("", seen.span.start_s..=seen.span.end_s).fill(shade));
        }
        add_bands(plot_ui, plots, visibility);
        for (pin, shape) in pinned {
            add_pinned(plot_ui, pin, shape, visibility, &times, columns);
        }
        add_dots(plot_ui, plots, visibility, &times, columns);
    });
    shown.paint_times(ui, &times);
    shown.on_click(&times, commands, |_| None);
    let chosen_mm = match (shown.moved_y, chosen_mm) {
        (None, chosen_mm) => chosen_mm,
        (Some(Moved::To(range_mm)), _) => Some(range_mm),
        // From what the plot shows by itself to everything, and from anything else back.
        (Some(Moved::Back), None) => Some(open.plots.all_mm()),
        (Some(Moved::Back), Some(_)) => None,
    };
    ui.data_mut(|data| data.insert_temp(chosen_id, chosen_mm));
}

fn add_bands<'a>(plot_ui: &mut PlotUi<'a>, plots: &'a PreparedPlots, visibility: &Visibility) {
    let pairs = (0..3).filter(|pair| visibility.uncertainty && visibility.pairs[*pair]);
    for pair in pairs {
        let fill = theme::rgb(palette::PAIRS[pair]).gamma_multiply(0.16);
        for Band { times_s, half_widths_mm } in &plots.bands[pair] {
            let lower: Vec<f64> = half_widths_mm.iter().map(|w| -w).collect();
            let area = FilledArea::new("", times_s, &lower, half_widths_mm);
            plot_ui.add(area.fill_color(fill).allow_hover(false));
        }
    }
}

fn add_dots(
    plot_ui: &mut PlotUi<'_>,
    plots: &PreparedPlots,
    visibility: &Visibility,
    times: &Times,
    columns: usize,
) {
    for pair in (0..3).filter(|pair| visibility.pairs[*pair]) {
        let dots = plots.residuals[pair].visible(times.window_s, columns.max(LEAST_RUNS));
        plot_ui.points(
            Points::new(format!("prisms {}", pair_label(pair)), PlotPoints::Owned(dots))
                .color(theme::rgb(palette::PAIRS[pair]))
                .radius(1.4),
        );
    }
}

/// How pinned results are told apart, beside their names.
const SHAPES: [MarkerShape; 4] =
    [MarkerShape::Circle, MarkerShape::Square, MarkerShape::Diamond, MarkerShape::Up];

fn sign(shape: MarkerShape) -> &'static str {
    match shape {
        MarkerShape::Square => "□",
        MarkerShape::Diamond => "◇",
        MarkerShape::Up => "△",
        _ => "○",
    }
}

/// Pinned results that are to be seen behind this deployment's: those of the same data.
fn pinned<'a>(open: &OpenDeployment, state: &'a State) -> Vec<(&'a Pin, MarkerShape)> {
    let Some(now) = &open.summary else { return Vec::new() };
    let pins = state.results.pins.iter().filter(|pin| pin.shown && pin.plots.is_some());
    let same = pins.filter(|pin| pin.summary.has_same_data(now));
    same.zip(SHAPES.into_iter().cycle()).collect()
}

/// Adds the residuals of a pinned result, hollow and faint.
fn add_pinned(
    plot_ui: &mut PlotUi<'_>,
    pin: &Pin,
    shape: MarkerShape,
    visibility: &Visibility,
    times: &Times,
    columns: usize,
) {
    let Some(plots) = &pin.plots else { return };
    for pair in (0..3).filter(|pair| visibility.pairs[*pair]) {
        let dots = plots.residuals[pair].visible(times.window_s, columns);
        let name = format!("prisms {}, {} (pinned)", pair_label(pair), pin.name);
        plot_ui.points(
            Points::new(name, PlotPoints::Owned(dots))
                .color(theme::rgb(palette::PAIRS[pair]).gamma_multiply(0.5))
                .shape(shape)
                .filled(false)
                .radius(2.6),
        );
    }
}

fn ui_shade(dark: bool) -> egui::Color32 {
    if dark { egui::Color32::from_white_alpha(7) } else { egui::Color32::from_black_alpha(9) }
}

/// The errors at the cursor, and how many lie outside what is shown: nothing is hidden without a word.
fn caption(
    open: &OpenDeployment,
    analysis: &Analysis,
    answer: &Answer,
    shown_mm: [f64; 2],
) -> String {
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
    let [outside, all] = open.plots.outside(shown_mm);
    if outside > 0 {
        parts.push(format!("{outside} of {all} beyond the range (double-click: all)"));
    }
    parts.join("  ·  ")
}
