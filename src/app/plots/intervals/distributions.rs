//! Distributions of the lengths of gaps and intervals, on logarithmic axes, with τ_s and τ_l as draggable lines.

use egui::{Color32, Rect, RichText};
use egui_plot::{AxisHints, GridInput, GridMark, Plot, PlotTransform};

use super::super::threshold::Threshold;
use super::super::time_plot::still;
use super::super::{LABELS, log_axis};
use super::gap_thresholds::GapThresholds;
use crate::app::model::OpenDeployment;
use crate::app::plots::rates::in_a_row;
use crate::app::prepared::gaps::LogHistogram;
use crate::app::state::State;
use crate::app::theme;
use resect_core::pipeline::SampleFate;
use resect_tools::palette;

/// Height of the line above each chart, and of its text; handles are below the text (points).
const TITLE: f32 = 21.0;
const TEXT: f32 = 13.0;
/// Least height of a chart (points).
const LEAST: f32 = 40.0;
/// Charts lower than this have no room for the name of their counts (points).
const LEAST_NAMED: f32 = 64.0;
/// Half the width of the number "100 s", as a share of the axis.
const HALF_A_NUMBER: f64 = 0.13;

/// Draws both distributions; returns the values of τ_s and τ_l that the user sets.
pub fn ui(
    ui: &mut egui::Ui,
    open: &OpenDeployment,
    state: &State,
    thresholds: &GapThresholds,
) -> [Option<f64>; 2] {
    ui.spacing_mut().item_spacing.y = 2.0;
    let gaps = &open.plots.gaps;
    let [tau_s, tau_l] = &thresholds.0;
    // Shows both charts if there is room; a low pane has the first chart, and only the count of the second.
    let of_two = ui.available_height() / 2.0 - TITLE - 4.0;
    let height = if of_two < LEAST { ui.available_height() - 2.0 * TITLE - 4.0 } else { of_two };
    let longer = in_a_row(&gaps.outages.map(Vec::len));
    let counted = "Number of silences by length and station; above: silences of stations 1 / 2 / … that are \
                   longer than τ_s";
    let short_of = |threshold: &Threshold<'_>| threshold.symbol.to_owned();
    title(ui, ["silences", ">"], [tau_s.label(), short_of(tau_s)], &longer, counted);
    let stations: Vec<(&LogHistogram, Color32)> = (state.visible_stations())
        .map(|station| (&gaps.lengths[station], theme::rgb(palette::station(station))))
        .collect();
    let silences = Distribution { name: "silences", threshold: tau_s.value, series: &stations };
    let (transform, frame) = silences.show(ui, open.id, height, |_| 1.0);
    let wanted_s =
        tau_s.vertical_line(ui, frame, x(&transform, tau_s.value), |x| at(&transform, x));

    let (short, all) = (gaps.short.len(), gaps.short.len() + gaps.kept.len());
    let shorter = format!("{short} of {all}");
    let counted = "Number of intervals by length; above: intervals that are not longer than τ_l";
    title(ui, ["intervals", "≤"], [tau_l.label(), short_of(tau_l)], &shorter, counted);
    if of_two < LEAST {
        return [wanted_s, None];
    }
    let kept = theme::rgb(palette::fate(SampleFate::Kept));
    let series = [(&gaps.interval_lengths, kept)];
    let intervals = Distribution { name: "intervals", threshold: tau_l.value, series: &series };
    let shortest = if tau_l.enabled { tau_l.value.max(1e-9).log10() } else { f64::NEG_INFINITY };
    let pale = |log10: f64| if log10 < shortest { 0.4 } else { 1.0 };
    let (transform, frame) = intervals.show(ui, open.id, height, pale);
    let wanted_l =
        tau_l.vertical_line(ui, frame, x(&transform, tau_l.value), |x| at(&transform, x));
    [wanted_s, wanted_l]
}

/// Shows the count beyond a threshold with the threshold's value, shortened in a narrow pane.
fn title(
    ui: &mut egui::Ui,
    [what, sign]: [&str; 2],
    [threshold, symbol]: [String; 2],
    count: &str,
    hint: &str,
) {
    let (rect, _) =
        ui.allocate_exact_size(egui::vec2(ui.available_width(), TITLE), egui::Sense::hover());
    let builder = egui::UiBuilder::new().max_rect(rect.with_max_y(rect.top() + TEXT));
    let mut line = ui.new_child(builder);
    let font = egui::TextStyle::Small.resolve(ui.style());
    let fits = |text: &&String| {
        let text = (*text).clone();
        let galley = ui.painter().layout_no_wrap(text, font.clone(), Color32::PLACEHOLDER);
        galley.size().x <= rect.width()
    };
    let texts = [
        format!("{what} {sign} {threshold}: {count}"),
        format!("{what} {sign} {symbol}: {count}"),
        format!("{sign} {symbol}: {count}"),
    ];
    let text = texts.iter().find(fits).unwrap_or(&texts[2]);
    let label = egui::Label::new(RichText::new(text).small()).truncate();
    let label = line.add(label.show_tooltip_when_elided(false));
    label.on_hover_text(format!("{}\n\n{hint}", texts[0]));
}

/// Position of a length on the screen, clamped to the axis.
fn x(transform: &PlotTransform, length_s: f64) -> f32 {
    let bounds = transform.bounds();
    let log10 = length_s.max(1e-9).log10().clamp(bounds.min()[0], bounds.max()[0]);
    transform.position_from_point_x(log10)
}

fn at(transform: &PlotTransform, x: f32) -> f64 {
    10_f64.powf(transform.value_from_position(egui::pos2(x, 0.0)).x)
}

struct Distribution<'a> {
    name: &'a str,
    threshold: f64,
    series: &'a [(&'a LogHistogram, Color32)],
}

impl Distribution<'_> {
    /// Draws the histogram; `strength` is the opacity of a bin by its middle (log10 of the length). The axis of counts is logarithmic as
    /// well, because a few long gaps matter as much as thousands of short ones.
    fn show(
        &self,
        ui: &mut egui::Ui,
        id: u64,
        height: f32,
        strength: impl Fn(f64) -> f32,
    ) -> (PlotTransform, Rect) {
        let bins = || self.series.iter().flat_map(|(histogram, _)| histogram.bins());
        let threshold = self.threshold.max(1e-3).log10();
        let ends = bins().map(|(ends, _)| ends);
        let [low, high] = ends.fold([threshold - 0.7, threshold + 0.7], |[low, high], [a, b]| {
            [low.min(a - 0.1), high.max(b + 0.1)]
        });
        // Extends the axis so that the number of the last power of ten is not clipped.
        let high = high.max(high.floor() + HALF_A_NUMBER * (high - low));
        let most = bins().map(|(_, count)| count).max().unwrap_or(1);
        let shown = still(Plot::new((self.name, id)))
            .height(height)
            .custom_x_axes(vec![
                AxisHints::new_x()
                    .tick_label_font(egui::FontId::proportional(11.0))
                    .formatter(|mark, _| format!("{} s", log_axis::number(mark.value)))
                    .label_spacing(LABELS),
            ])
            .custom_y_axes(vec![
                AxisHints::new_y()
                    .label(RichText::new(if height < LEAST_NAMED { "" } else { "count" }).small())
                    .tick_label_font(egui::FontId::proportional(11.0))
                    .formatter(|mark, _| format!("{:.0}", 10_f64.powf(mark.value) - 1.0))
                    .label_spacing(8.0..=14.0)
                    .min_thickness(if height < LEAST_NAMED { 26.0 } else { 40.0 }),
            ])
            .x_grid_spacer(log_axis::many_decades)
            .y_grid_spacer(counts)
            .label_formatter(|_| None)
            .sense(egui::Sense::hover())
            .show(ui, |plot_ui| {
                plot_ui.set_plot_bounds_x(low..=high);
                plot_ui.set_plot_bounds_y(0.0..=1.1 * place(most));
            });
        let transform = shown.transform;
        let frame = *transform.frame();
        let painter = ui.painter().with_clip_rect(frame);
        // The bars of the stations are side by side within a bin, so that none hides another.
        let beside = 1.0 / self.series.len().max(1) as f64;
        for (index, (histogram, colour)) in self.series.iter().enumerate() {
            for ([a, b], count) in histogram.bins() {
                let left = a + (b - a) * beside * index as f64;
                let x = [left, left + (b - a) * beside].map(|x| transform.position_from_point_x(x));
                let top = transform.position_from_point_y(place(count));
                let bar = Rect::from_x_y_ranges(x[0]..=x[1], top..=frame.bottom());
                painter.rect_filled(bar, 0.0, colour.gamma_multiply(strength((a + b) / 2.0)));
            }
        }
        (transform, frame)
    }
}

/// Position of a count on its axis: 0 at zero, and visible at one.
fn place(count: usize) -> f64 {
    (count as f64 + 1.0).log10()
}

#[expect(clippy::needless_pass_by_value, reason = "egui_plot hands it over")]
fn counts(input: GridInput) -> Vec<GridMark> {
    let shown = |mark: &GridMark| mark.value <= input.bounds.1;
    // In a low chart, only the powers of ten keep their numbers.
    let marks = (0..7).flat_map(|decade| {
        [(1, 1.0), (3, 0.4)].map(|(times, step_size)| GridMark {
            value: place(times * 10_usize.pow(decade)),
            step_size,
        })
    });
    marks.filter(shown).collect()
}
