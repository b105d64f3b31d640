//! Distributions of the distance errors, one strip per pair: all errors, overlaid with those of the selected times.

use resect_core::network::{Number, Pair};
use std::sync::Arc;

use egui::{Color32, FontId, RichText};
use egui_plot::{AxisHints, Line, Plot, PlotPoints, PlotResponse, VLine};

use super::navigation::{self, Moved};
use super::time_plot::still;
use super::{answer_with_errors, axis_below, close_marks, pair_name, round_marks};
use crate::app::model::OpenDeployment;
use crate::app::prepared::plots::Distributions;
use crate::app::state::State;
use crate::app::theme;
use resect_core::evaluation::Spread;
use resect_tools::palette;

/// Height of the axis at the bottom, with its name and with its numbers alone (points).
const AXIS: f32 = 34.0;
const AXIS_NUMBERS: f32 = 18.0;
/// Width of the numbers at the left (points).
const NUMBERS: f32 = 46.0;
const LEAST: f32 = 20.0;
/// Plots lower than this omit what is shown elsewhere: the text on all pairs, and the name of the axis (points).
const LEAST_NAMED: f32 = 26.0;
/// Height of a line of text (points).
const LINE: f32 = 15.0;
/// Panes narrower than this show the selection on a separate line (points).
const NARROW: f32 = 420.0;
/// Panes narrower than this omit the names of the numbers (points).
const SHORT: f32 = 260.0;
/// Plots lower than this show only the unit at their axis (points).
const LOW: f32 = 90.0;

pub fn ui(ui: &mut egui::Ui, state: &State) {
    let Some((open, ..)) = answer_with_errors(ui, state) else { return };
    if state.is_stale() {
        ui.multiply_opacity(0.45);
    }
    // The name of an axis extends a little beyond it.
    let margin = egui::Margin { left: 4, right: 6, top: 0, bottom: 3 };
    egui::Frame::new().inner_margin(margin).show(ui, |ui| strips(ui, state, open));
}

fn strips(ui: &mut egui::Ui, state: &State, open: &OpenDeployment) {
    let (all, selected) = (&open.plots.distributions, selected(ui, open));
    // Range of errors to which the user zoomed; otherwise the plots follow the result.
    let chosen_id = ui.scope_id().with(("chosen errors", open.id));
    let chosen_mm: Option<[f64; 2]> = ui.data(|data| data.get_temp(chosen_id)).unwrap_or_default();
    let shown_mm = within(chosen_mm.unwrap_or(open.plots.range_mm), open.plots.range_mm);
    let mut moved = None;
    ui.spacing_mut().item_spacing.y = 1.0;
    let two_lines = selected.is_some() && ui.available_width() < NARROW;
    let of_selected = |of: fn(&Distributions) -> Option<Spread>| selected.as_deref().map(of);
    let pairs: Vec<usize> =
        (0..all.outlines.len()).filter(|pair| state.scene.visibility.pairs[*pair]).collect();
    let lines = if two_lines { 2.0 } else { 1.0 } * LINE + 3.0;
    let rows = pairs.len().max(1) as f32;
    let height_over = |others: f32| (ui.available_height() - others - rows * lines) / rows;
    let is_low = height_over(AXIS + lines) < LEAST_NAMED;
    let axis = if is_low { AXIS_NUMBERS } else { AXIS };
    let height = height_over(axis + if is_low { 0.0 } else { lines }).max(LEAST);
    if !is_low {
        let selected = of_selected(|it| it.all_mm);
        words(ui, RichText::new("all").strong(), all.all_mm, selected, two_lines);
    }
    for (row, pair) in pairs.iter().copied().enumerate() {
        let name = pair_name(pair, ui.visuals().dark_mode);
        let part = selected.as_deref().map(|it| it.by_pair_mm[pair]);
        words(ui, name, all.by_pair_mm[pair], part, two_lines);
        let axis = (row + 1 == pairs.len()).then_some(axis);
        let plot = PairHistogram { open, pair, shown_mm, height, axis };
        let shown = plot.show(ui, all, selected.as_deref());
        moved = moved.or(navigation::along_x(ui, &shown.response, &shown.transform));
    }
    let chosen_mm = match moved {
        None => chosen_mm,
        Some(Moved::To(range_mm)) => Some(range_mm),
        Some(Moved::Back) => None,
    };
    ui.data_mut(|data| data.insert_temp(chosen_id, chosen_mm));
}

/// Shifts a range into a whole range, and shortens it if it is longer.
fn within([low, high]: [f64; 2], whole: [f64; 2]) -> [f64; 2] {
    let length = (high - low).min(whole[1] - whole[0]);
    let low = low.min(whole[1] - length).max(whole[0]);
    [low, low + length]
}

/// The histogram of one pair's errors.
struct PairHistogram<'a> {
    open: &'a OpenDeployment,
    pair: usize,
    shown_mm: [f64; 2],
    height: f32,
    /// Height of the axis below the plot (points); `None` unless this is the lowest plot.
    axis: Option<f32>,
}

impl PairHistogram<'_> {
    /// Draws an outline of all errors, filled for the selected times if there are any.
    fn show(
        &self,
        ui: &mut egui::Ui,
        all: &Distributions,
        selected: Option<&Distributions>,
    ) -> PlotResponse<()> {
        let Self { open, pair, shown_mm: [low, high], height, axis } = *self;
        let small = || FontId::proportional(11.0);
        let unit = match height < LOW {
            true => "%".to_owned(),
            false => format!("% per {:.2} mm", all.bin_width_mm),
        };
        let y_axis = AxisHints::new_y()
            .label(RichText::new(unit).small())
            .label_spacing(9.0..=16.0)
            .tick_label_font(small())
            .min_thickness(NUMBERS);
        let x_axis = axis.map(|axis| {
            axis_below(if axis < AXIS { "" } else { "error (mm)" }).min_thickness(axis)
        });
        let highest = selected.map_or(0.0, |it| it.highest_percent).max(all.highest_percent);
        let zero = theme::faint(ui.visuals().dark_mode);
        let colour = theme::rgb(palette::pair(pair));
        let name = format!("distribution of the errors {}", Pair::at(pair));
        let shown = still(Plot::new(("histogram", open.id, pair)))
            .height(height + axis.unwrap_or(0.0))
            .custom_x_axes(x_axis.into_iter().collect())
            .custom_y_axes(vec![y_axis])
            .x_grid_spacer(round_marks)
            .y_grid_spacer(close_marks)
            .label_formatter(|_| None)
            .show(ui, |plot_ui| {
                plot_ui.set_plot_bounds_x(low..=high);
                plot_ui.set_plot_bounds_y(0.0..=1.08 * highest.max(1.0));
                plot_ui.vline(VLine::new("", 0.0).color(zero).width(0.8));
                let outline = |of: &Distributions, ink: Color32, fill: f32| {
                    let corners = PlotPoints::Owned(of.outlines[pair].clone());
                    let line = Line::new("", corners).color(ink).width(1.2);
                    // Without this, `egui_plot` draws the vertical edges as slanted bands.
                    line.fill(0.0).fill_alpha(fill).allow_band(false)
                };
                match selected {
                    Some(selected) => {
                        plot_ui.line(outline(selected, colour, 0.45));
                        plot_ui.line(outline(all, zero, 0.0));
                    }
                    None => plot_ui.line(outline(all, colour, 0.3)),
                }
            });
        let role = egui::accesskit::Role::Canvas;
        shown.response.widget_info(|| egui::WidgetInfo::labeled(role, ui.is_enabled(), &name));
        shown
    }
}

/// Shows "1–2  median |e| 0.95 mm, IQR 1.43, n 3041", and the same for the selection.
fn words(
    ui: &mut egui::Ui,
    name: RichText,
    all: Option<Spread>,
    selected: Option<Option<Spread>>,
    two_lines: bool,
) {
    let hint = "|e|: absolute error, apparent minus known distance. IQR: interquartile range. \
                Scroll: zoom; right drag: move; double-click: all.";
    let told = if ui.available_width() < SHORT { in_short } else { in_words };
    let part = selected.map(|spread| format!("selected: {}", told(spread)));
    let label = |ui: &mut egui::Ui, text: RichText| {
        ui.add(egui::Label::new(text.small()).truncate()).on_hover_text(hint);
    };
    ui.horizontal(|ui| {
        ui.set_height(LINE);
        ui.add_space(6.0);
        label(ui, name);
        label(ui, RichText::new(told(all)));
        if let Some(part) = part.as_ref().filter(|_| !two_lines) {
            label(ui, RichText::new(part).strong());
        }
    });
    if let Some(part) = part.filter(|_| two_lines) {
        ui.horizontal(|ui| {
            ui.set_height(LINE);
            ui.add_space(6.0);
            label(ui, RichText::new(part).strong());
        });
    }
}

/// Formats "median |e| 0.95 mm, IQR 1.43, n 3041".
pub fn in_words(spread: Option<Spread>) -> String {
    spread.map_or_else(
        || "no triplets".to_owned(),
        |Spread { median, iqr, n, .. }| {
            format!("median |e| {median:.2}\u{a0}mm, IQR\u{a0}{iqr:.2}, n\u{a0}{n}")
        },
    )
}

/// Formats "|e| 0.95, IQR 1.43 mm": median and interquartile range, without room for their names, which hovering shows.
pub fn in_short(spread: Option<Spread>) -> String {
    spread.map_or_else(
        || "no triplets".to_owned(),
        |Spread { median, iqr, .. }| format!("|e| {median:.2}, IQR {iqr:.2}\u{a0}mm"),
    )
}

/// Distributions of the errors at the selected times; cached until the selection changes.
pub fn selected(ui: &egui::Ui, open: &OpenDeployment) -> Option<Arc<Distributions>> {
    let span_s = open.timeline.selection_s?.map(|time_s| time_s - open.start_s());
    let key = (open.id, open.analysis_run, span_s.map(f64::to_bits));
    let id = egui::Id::unique("distributions of the selected times");
    type Known = ((u64, u64, [u64; 2]), Arc<Distributions>);
    let known: Option<Known> = ui.data(|data| data.get_temp(id));
    if let Some((_, distributions)) = known.filter(|(known, _)| *known == key) {
        return Some(distributions);
    }
    let distributions = Arc::new(open.plots.distributions_within(span_s));
    ui.data_mut(|data| data.insert_temp(id, (key, Arc::clone(&distributions))));
    Some(distributions)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_zoomed_to_stays_within_what_there_is() {
        let whole = [-5.0, 5.0];
        assert_eq!(within([-1.0, 2.0], whole), [-1.0, 2.0]);
        assert_eq!(within([-7.0, -3.0], whole), [-5.0, -1.0]);
        assert_eq!(within([4.0, 9.0], whole), [0.0, 5.0]);
        assert_eq!(within([-90.0, 4.0], whole), whole);
    }
}
