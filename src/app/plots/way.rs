//! The trajectory over time: where the vehicle was with its σ, and in [`super::estimate_errors`] how far off the trajectories of
//! other systems are.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{PopupCloseBehavior, RichText};
use egui_plot::{FilledArea, HoverPosition, Line, Plot, PlotPoint, PlotPoints};

use super::dimension_units::{per_stored, unit};
use super::estimate_errors;
use super::strips::{Strip, strips};
use super::time_plot::{self, TimePlot};
use super::times::Times;
use super::{close_marks, in_the_middle, with_room};
use crate::app::model::estimates::Shown;
use crate::app::model::{Commands, OpenDeployment, TimeCommand, Units, WayPlots};
use crate::app::prepared::aspects::Aspect;
use crate::app::prepared::way::{Instant, Way};
use crate::app::state::State;
use crate::app::theme;
use resect_core::estimates::Judged;
use resect_core::palette;
use resect_core::statistics::tables::NORMAL_95;

/// The switches stand in a line where there is more room than this (points), more with those of errors, and in a menu otherwise.
const WIDE: f32 = 550.0;
const WIDE_WITH_ERRORS: f32 = 780.0;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let Some((open, _)) = state.analysed() else {
        in_the_middle(ui, "Nothing open.");
        return;
    };
    if state.is_stale() {
        ui.multiply_opacity(0.45);
    }
    let times = Times::of(open, state);
    let plots = state.time.way_plots;
    let judging = &open.judging;
    time_plot::head(ui, |ui| {
        let can_judge = !judging.added.is_empty();
        if ui.available_width() > if can_judge { WIDE_WITH_ERRORS } else { WIDE } {
            switches(ui, plots, can_judge, commands);
        } else {
            let stays = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
            MenuButton::new("Show…").config(stays).ui(ui, |ui| {
                switches(ui, plots, can_judge, commands);
            });
        }
        time_plot::selection(ui, &times, commands);
        // Errors over the driven way are not over time: nothing is selected there.
        if !(plots.errors && plots.by_distance) || plots.aspects().next().is_some() {
            time_plot::hint(ui, "");
        }
    });
    let judged: Vec<(usize, &Judged)> =
        if plots.errors { judging.judged().collect() } else { Vec::new() };
    let aspects: Vec<Aspect> = plots.aspects().collect();
    if judged.is_empty() && aspects.is_empty() {
        let why = match judging.judgement.is_running() {
            true => "Judging…",
            false if plots.errors && !judging.added.is_empty() => {
                "No trajectory could be judged: Evaluation says why."
            }
            false => "Nothing is chosen to be shown here.",
        };
        in_the_middle(ui, why);
        return;
    }
    let way = open.way.newest.as_deref();
    let why_not = way.and_then(|way| way.why_not.as_ref());
    if let Some(why) = why_not.filter(|_| judged.is_empty()) {
        in_the_middle(ui, why);
        return;
    }
    let places = strips(ui, judged.len() + aspects.len(), 2);
    let (of_errors, of_aspects) = places.split_at(judged.len());
    estimate_errors::show(ui, state, (open, &times), of_errors, &judged, commands);
    for (strip, aspect) in of_aspects.iter().zip(aspects) {
        let plot = AspectPlot { open, times: &times, units: state.workspace.units, aspect };
        plot.show(ui, strip, way, commands);
    }
}

/// What is to be plotted, one switch each.
fn switches(ui: &mut egui::Ui, plots: WayPlots, can_judge: bool, commands: &mut Commands) {
    let mut chosen = plots;
    if can_judge {
        ui.checkbox(&mut chosen.errors, "errors").on_hover_text(
            "How far off each trajectory is that was added, over what the ground truth leaves open",
        );
        ui.add_enabled_ui(plots.errors, |ui| {
            ui.checkbox(&mut chosen.by_distance, "by distance")
                .on_hover_text("Errors over the way that was driven, instead of over time");
            ui.checkbox(&mut chosen.one_scale, "one scale")
                .on_hover_text("All errors on the same scale, so that heights compare");
        });
    }
    for (aspect, on) in Aspect::ALL.into_iter().zip(&mut chosen.aspects) {
        ui.checkbox(on, aspect.name()).on_hover_text(aspect.hint());
    }
    if chosen != plots {
        commands.push(TimeCommand::PlotWay(chosen).into());
    }
}

/// The strip of one aspect of the way.
struct AspectPlot<'a> {
    open: &'a OpenDeployment,
    times: &'a Times,
    units: Units,
    aspect: Aspect,
}

impl AspectPlot<'_> {
    fn show(&self, ui: &mut egui::Ui, strip: &Strip, way: Option<&Way>, commands: &mut Commands) {
        let (times, aspect) = (self.times, self.aspect);
        let (factor, unit) = shown_in(aspect, self.units);
        let span_s = times.window_s.map(|since_s| since_s + times.start_s);
        let corners = (strip.plot.width() as usize).max(100);
        let lines: Vec<Vec<Corner>> = way.map_or(Vec::new(), |way| {
            let pieces = way.pieces(span_s).flat_map(|piece| split_at_turns(piece, aspect));
            let corner = |some: &[Instant]| Corner::of(some, aspect, factor, times.start_s);
            let most = way.instants.len().min((10.0 * (span_s[1] - span_s[0])) as usize + 1);
            let stride = most.div_ceil(corners).max(1);
            pieces.map(|piece| piece.chunks(stride).filter_map(corner).collect()).collect()
        });
        let y_bounds =
            with_room(lines.iter().flatten().flat_map(|corner| [corner.low, corner.high]));
        let scale = times.scale;
        let plot = Plot::new(("way", self.open.id, aspect.name()))
            .y_grid_spacer(close_marks)
            .label_formatter(move |position| match position {
                HoverPosition::NearDataPoint { position, .. } => {
                    let time = scale.text_and_seconds(position.x, 1);
                    Some(format!("{}\n{time}\n{:.4} {unit}", aspect.name(), position.y))
                }
                HoverPosition::Elsewhere { .. } => None,
            });
        let name = format!("{} over time", aspect.name());
        let axis = strip.value_axis(aspect.name(), unit);
        let colour = theme::rgb(palette::METRICS[0]);
        let time_plot = TimePlot { strip, name: &name, times, y_bounds };
        let shown = time_plot.show(ui, plot, axis, commands, |plot_ui| {
            for line in lines {
                let of = |value: fn(&Corner) -> f64| line.iter().map(value).collect::<Vec<f64>>();
                let band = FilledArea::new("", &of(|c| c.x), &of(|c| c.low), &of(|c| c.high));
                plot_ui.add(band.fill_color(colour.gamma_multiply(0.35)).allow_hover(false));
                let points = line.iter().map(|c| PlotPoint::new(c.x, c.value)).collect();
                let line = Line::new(aspect.name(), PlotPoints::Owned(points));
                plot_ui.line(line.color(colour).width(1.6));
            }
        });
        shown.paint_times(ui, times);
        shown.on_click(times, commands, |_| None);
        self.words(ui, strip, way);
    }

    /// What it is at the cursor.
    fn words(&self, ui: &mut egui::Ui, strip: &Strip, way: Option<&Way>) {
        let cursor_s = self.open.timeline.cursor_s;
        let at = cursor_s.and_then(|cursor_s| self.aspect.of(&way?.at(cursor_s)?));
        let (factor, unit) = shown_in(self.aspect, self.units);
        let text = match at {
            None => "not known at the cursor".to_owned(),
            Some(at) if at.sigma > 0.0 => {
                Shown::new(factor * at.value, Some(factor * at.sigma), unit, 3).in_words()
            }
            Some(at) => format!("{:.2} {unit}", factor * at.value),
        };
        let lines = [RichText::new(self.aspect.name()).strong(), RichText::new(text)];
        strip.words(ui, &lines, self.aspect.hint());
    }
}

/// Factor of stored values to the unit in which they are shown, and that unit.
fn shown_in(aspect: Aspect, units: Units) -> (f64, &'static str) {
    let dimension = aspect.dimension();
    (per_stored(dimension, units), unit(dimension, units))
}

/// One place of a line with its band, which may sum up several instants.
struct Corner {
    x: f64,
    value: f64,
    low: f64,
    high: f64,
}

impl Corner {
    fn of(some: &[Instant], aspect: Aspect, factor: f64, start_s: f64) -> Option<Self> {
        let middle = &some[some.len() / 2];
        let value = factor * aspect.of(middle)?.value;
        let mut corner =
            Self { x: middle.time_s - start_s, value, low: f64::INFINITY, high: f64::NEG_INFINITY };
        for at in some.iter().filter_map(|at| aspect.of(at)) {
            let half = NORMAL_95 * at.sigma;
            corner.low = corner.low.min(factor * (at.value - half));
            corner.high = corner.high.max(factor * (at.value + half));
        }
        Some(corner)
    }
}

/// Parts between which an angle goes from one half turn to the other: no line leads across.
fn split_at_turns(piece: &[Instant], aspect: Aspect) -> impl Iterator<Item = &[Instant]> {
    let is_angle = matches!(aspect, Aspect::Heading | Aspect::Roll | Aspect::Pitch);
    piece.chunk_by(move |a, b| {
        let both = aspect.of(a).zip(aspect.of(b)).filter(|_| is_angle);
        both.is_none_or(|(a, b)| (b.value - a.value).abs() < std::f64::consts::PI)
    })
}
