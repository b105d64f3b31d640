//! Distance errors over time, one strip per pair: dots under their running median and quartiles, over the accepted intervals, with the time
//! cursor.

use egui::RichText;
use egui_plot::{
    FilledArea, HoverPosition, Line, MarkerShape, Plot, PlotPoint, PlotPoints, PlotUi, Points,
};
use resect_core::network::{Number, Pair};

use super::marks::Marks;
use super::navigation::Moved;
use super::quads::Shades;
use super::strips::{Strip, strips};
use super::time_plot::{self, ShownPlot, TimePlot};
use super::times::Times;
use super::{answer_with_errors, close_marks, histogram, pair_name, pair_switches};
use crate::app::model::{Commands, OpenDeployment, Pin};
use crate::app::prepared::plots::{Band, Distributions};
use crate::app::prepared::rig_at::are_together_at;
use crate::app::prepared::{Piece, gaps};
use crate::app::state::State;
use crate::app::theme;
use crate::app::words;
use resect_core::analysis::{Analysis, Answer};
use resect_report::glossary;
use resect_tools::palette;

/// Width that one corner of the running median summarises (points).
const CORNER: f32 = 7.0;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let Some((open, analysis, answer)) = answer_with_errors(ui, state) else { return };
    if state.is_stale() {
        ui.multiply_opacity(0.45);
    }
    let times = Times::of(open, state);
    // Range of errors chosen by the user; otherwise the plot follows the result.
    let chosen_id = ui.scope_id().with(("chosen errors", open.id));
    let chosen_mm: Option<[f64; 2]> = ui.data(|data| data.get_temp(chosen_id)).unwrap_or_default();
    let shown_mm = chosen_mm.unwrap_or(open.plots.range_mm);
    time_plot::head(ui, |ui| {
        pair_switches(ui, state, commands);
        for (pin, shape) in pinned(open, state) {
            let text = format!("{} {}", sign(shape), pin.name);
            ui.small(text).on_hover_text("A pinned result, behind the present one");
        }
        time_plot::selection(ui, state, &times, commands);
        let text = caption(state, (open, analysis), &times, shown_mm);
        let label = egui::Label::new(RichText::new(text).small()).truncate();
        words::explain(ui.add(label), &glossary::INTER_PRISM_METRIC);
        time_plot::hint(ui, state, " · ctrl+scroll: zoom in mm");
    });
    let pairs = 0..open.plots.residuals.len();
    let pairs: Vec<usize> = pairs.filter(|pair| state.scene.visibility.pairs[*pair]).collect();
    let selected = histogram::selected(ui, open);
    let mut moved = None;
    for (strip, pair) in strips(ui, pairs.len(), 1).iter().zip(pairs) {
        let plot = PairPlot { open, state, times: &times, pair, shown_mm };
        let shown = plot.show(ui, strip, commands);
        plot.words(ui, strip, analysis, answer, selected.as_deref());
        moved = moved.or(shown.moved_y);
    }
    let chosen_mm = match (moved, chosen_mm) {
        (None, chosen_mm) => chosen_mm,
        (Some(Moved::To(range_mm)), _) => Some(range_mm),
        // A double click shows all errors, and a second one returns to the automatic range.
        (Some(Moved::Back), None) => Some(open.plots.all_mm()),
        (Some(Moved::Back), Some(_)) => None,
    };
    ui.data_mut(|data| data.insert_temp(chosen_id, chosen_mm));
}

/// The strip of one pair of prisms.
struct PairPlot<'a> {
    open: &'a OpenDeployment,
    state: &'a State,
    times: &'a Times,
    pair: usize,
    shown_mm: [f64; 2],
}

impl PairPlot<'_> {
    fn show(&self, ui: &mut egui::Ui, strip: &Strip, commands: &mut Commands) -> ShownPlot {
        let (times, plots) = (self.times, &self.open.plots);
        let scale = times.scale;
        let plot = Plot::new(("residuals", self.open.id, self.pair))
            .y_grid_spacer(close_marks)
            .label_formatter(move |position| match position {
                HoverPosition::NearDataPoint { plot_name, position, .. } => {
                    let time = scale.text_and_seconds(position.x, 1);
                    Some(format!("{plot_name}\n{time}\n{:+.2} mm", position.y))
                }
                HoverPosition::Elsewhere { .. } => None,
            });
        let name = format!("distance errors {} over time", Pair::at(self.pair));
        let axis = strip.value_axis(&Pair::at(self.pair).to_string(), "mm");
        let columns = strip.plot.width() as usize;
        let dark = ui.visuals().dark_mode;
        let zero = theme::faint(dark).gamma_multiply(0.8);
        let pinned = pinned(self.open, self.state);
        let time_plot = TimePlot { strip, name: &name, times, y_bounds: self.shown_mm };
        let shown = time_plot.show(ui, plot, axis, commands, |plot_ui| {
            let s_per_column = (times.window_s[1] - times.window_s[0]) / columns.max(1) as f64;
            let kept = gaps::visible(&plots.gaps.kept, times.window_s, s_per_column);
            let kept = kept.into_iter().map(|seen| seen.span).collect();
            plot_ui.add(Shades::new(kept, interval_shade(dark)));
            if self.state.scene.visibility.uncertainty {
                add_bands(plot_ui, &plots.bands[self.pair], theme::faint(dark));
            }
            plot_ui.hline(egui_plot::HLine::new("", 0.0).color(zero).width(0.8));
            for (pin, shape) in pinned {
                self.add_pinned(plot_ui, pin, shape, columns);
            }
            let dots = plots.residuals[self.pair].cloud(times.window_s, columns);
            let name = format!("prisms {}", Pair::at(self.pair));
            plot_ui.add(Marks::dots(name, dots, self.colour().gamma_multiply(0.34)));
            let most = (strip.plot.width() / CORNER) as usize;
            for piece in plots.residuals[self.pair].running.visible(times.window_s, most) {
                self.add_usual(plot_ui, &piece, dark);
            }
        });
        shown.paint_times(ui, times);
        shown.on_click(times, commands, |_| None);
        shown
    }

    fn colour(&self) -> egui::Color32 {
        theme::rgb(palette::pair(self.pair))
    }

    /// Draws the running median over a band between the quartiles.
    fn add_usual(&self, plot_ui: &mut PlotUi<'_>, piece: &Piece, dark: bool) {
        let Piece { times_s, q25, median, q75 } = piece;
        let band = FilledArea::new("", times_s, q25, q75);
        let fill = self.colour().gamma_multiply(0.5);
        plot_ui.add(band.fill_color(fill).allow_hover(false));
        let line = times_s.iter().zip(median).map(|(time_s, mm)| PlotPoint::new(*time_s, *mm));
        let line = Line::new("", PlotPoints::Owned(line.collect())).allow_hover(false);
        let strong = theme::rgb(palette::pair(self.pair))
            .lerp_to_gamma(if dark { egui::Color32::WHITE } else { egui::Color32::BLACK }, 0.45);
        plot_ui.line(line.color(strong).width(1.8));
    }

    /// Draws the residuals of a pinned result, hollow and faint.
    fn add_pinned(&self, plot_ui: &mut PlotUi<'_>, pin: &Pin, shape: MarkerShape, columns: usize) {
        let Some(plots) = &pin.plots else { return };
        let dots = plots.residuals[self.pair].visible(self.times.window_s, columns);
        let name = format!("prisms {}, {} (pinned)", Pair::at(self.pair), pin.name);
        plot_ui.points(
            Points::new(name, PlotPoints::Owned(dots))
                .color(self.colour().gamma_multiply(0.5))
                .shape(shape)
                .filled(false)
                .radius(2.6),
        );
    }

    /// Shows the spread of the pair's errors, and the error at the cursor.
    fn words(
        &self,
        ui: &mut egui::Ui,
        strip: &Strip,
        analysis: &Analysis,
        answer: &Answer,
        selected: Option<&Distributions>,
    ) {
        let evaluation = &answer.evaluation;
        // Without room, only the numbers are shown.
        let (in_words, cursor): (fn(_) -> _, _) = match strip.is_tight() {
            true => (histogram::in_short, "cursor"),
            false => (histogram::in_words, "at the cursor"),
        };
        let all = in_words(evaluation.inter_prism_by_pair_mm[self.pair]);
        let mut lines = vec![pair_name(self.pair, ui.visuals().dark_mode), RichText::new(all)];
        if let Some(selected) = selected {
            let text = in_words(selected.by_pair_mm[self.pair]);
            lines.push(RichText::new(format!("selected: {text}")).strong());
        }
        let cursor_s = self.open.timeline.cursor_s.filter(|t| are_together_at(analysis, *t));
        let at = cursor_s.and_then(|t| analysis.triplets().nearest(t));
        match at.and_then(|at| evaluation.distance_errors_mm[self.pair].get(at)) {
            // Adding zero turns a rounded -0.0 into 0.0.
            Some(error) => {
                let error_mm = (10.0 * error).round() / 10.0 + 0.0;
                lines.push(RichText::new(format!("{cursor} {error_mm:+.1}\u{a0}mm")));
            }
            None if self.open.timeline.cursor_s.is_some() => {
                lines.push(RichText::new(format!("{cursor} no triplet")));
            }
            None => {}
        }
        let hint = "Dots: error of each triplet, apparent minus known distance. Line: running median. Band: \
                    interquartile range.";
        strip.words(ui, &lines, hint);
    }
}

/// Draws bands of ±2 σ of the interpolation about zero.
fn add_bands(plot_ui: &mut PlotUi<'_>, bands: &[Band], ink: egui::Color32) {
    for Band { times_s, half_widths_mm } in bands {
        let lower: Vec<f64> = half_widths_mm.iter().map(|w| -w).collect();
        let area = FilledArea::new("", times_s, &lower, half_widths_mm);
        plot_ui.add(area.fill_color(ink.gamma_multiply(0.28)).allow_hover(false));
    }
}

/// Shapes that distinguish pinned results in the plot, also shown beside their names.
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

/// Pinned results of the same data, drawn behind this deployment's result.
fn pinned<'a>(open: &OpenDeployment, state: &'a State) -> Vec<(&'a Pin, MarkerShape)> {
    let Some(now) = &open.summary else { return Vec::new() };
    let pins = state.results.pins.iter().filter(|pin| pin.shown && pin.plots.is_some());
    let same = pins.filter(|pin| pin.summary.has_same_data(now));
    same.zip(SHAPES.into_iter().cycle()).collect()
}

fn interval_shade(dark: bool) -> egui::Color32 {
    if dark { egui::Color32::from_white_alpha(7) } else { egui::Color32::from_black_alpha(9) }
}

/// Text of the time at the cursor, and of the number of errors outside the range shown.
fn caption(
    state: &State,
    (open, analysis): (&OpenDeployment, &Analysis),
    times: &Times,
    shown_mm: [f64; 2],
) -> String {
    let mut parts = Vec::new();
    if let Some(cursor_s) = open.timeline.cursor_s
        && analysis.triplets().nearest(cursor_s).is_none()
    {
        let at = times.scale.text(cursor_s - open.start_s(), 1);
        parts.push(format!("{at}: in no interval"));
    }
    let [outside, all] = open.plots.outside(shown_mm);
    if outside > 0 {
        let hint = if state.workspace.picturing { "" } else { " (double-click: all)" };
        parts.push(format!("{outside} of {all} beyond the range{hint}"));
    }
    if open.plots.bands.iter().any(|bands| !bands.is_empty()) {
        parts.push("grey band: ±2σ of the interpolation".to_owned());
    }
    parts.join("  ·  ")
}
