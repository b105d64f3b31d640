//! The trajectory over time: where the vehicle was with its σ, and how far off the trajectories of other systems are.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Color32, PopupCloseBehavior, RichText};
use egui_plot::{FilledArea, HoverPosition, Line, Plot, PlotPoint, PlotPoints, PlotUi};

use super::quads::Shades;
use super::strips::{Strip, strips};
use super::time_plot::{self, TimePlot};
use super::times::Times;
use super::{close_marks, with_room};
use crate::app::model::estimates::Shown;
use crate::app::model::{Command, Commands, OpenDeployment, Units, WayPlots};
use crate::app::prepared::way::{Aspect, Instant, Way};
use crate::app::state::State;
use crate::app::theme;
use crate::estimates::Judged;
use crate::estimates::errors::EpochError;
use crate::estimates::odd::OddOne;
use crate::palette;
use crate::pipeline::Interval;

/// Half the width of a 95 % region along an axis (σ).
const HALF_95: f64 = 1.96;
/// The axis of errors that are all nothing reaches so far (mm).
const LEAST_ERROR_MM: f64 = 1e-3;
/// Width of what one corner of such a line sums up (points).
const CORNER: f32 = 3.0;
/// A line of an estimate's errors is broken where it has no ground truth for longer (s).
const GAP_S: f64 = 1.0;
/// The switches stand in a line where there is more room than this (points), and in a menu otherwise.
const WIDE: f32 = 550.0;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let Some((open, _)) = state.analysed() else {
        ui.centered_and_justified(|ui| ui.weak("Nothing open."));
        return;
    };
    if state.is_stale() {
        ui.multiply_opacity(0.45);
    }
    let times = Times::of(open, state);
    let plots = state.way_plots;
    let judging = &open.judging;
    time_plot::head(ui, |ui| {
        let can_judge = !judging.estimates.is_empty();
        if ui.available_width() > WIDE {
            switches(ui, plots, can_judge, commands);
        } else {
            let stays = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
            MenuButton::new("Show…").config(stays).ui(ui, |ui| {
                switches(ui, plots, can_judge, commands);
            });
        }
        time_plot::selection(ui, &times, commands);
        time_plot::hint(ui, "");
    });
    let judged: Vec<(usize, &Judged)> =
        if plots.errors { judging.judged().collect() } else { Vec::new() };
    let aspects: Vec<Aspect> = plots.aspects().collect();
    if judged.is_empty() && aspects.is_empty() {
        let why = match judging.judgement.is_running() {
            true => "Judging…",
            false if plots.errors && !judging.estimates.is_empty() => {
                "No trajectory could be judged: Evaluation says why."
            }
            false => "Nothing is chosen.",
        };
        ui.centered_and_justified(|ui| ui.weak(why));
        return;
    }
    let way = open.way.newest.as_deref();
    let why_not = way.and_then(|way| way.why_not.as_ref());
    if let Some(why) = why_not.filter(|_| judged.is_empty()) {
        ui.centered_and_justified(|ui| ui.weak(why));
        return;
    }
    let places = strips(ui, judged.len() + aspects.len(), 2);
    let (of_errors, of_aspects) = places.split_at(judged.len());
    for (strip, (place, one)) in of_errors.iter().zip(judged) {
        show_errors(ui, (open, &times), strip, (place, one), commands);
    }
    for (strip, aspect) in of_aspects.iter().zip(aspects) {
        let plot = AspectPlot { open, times: &times, units: state.units, aspect };
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
    }
    for (aspect, on) in Aspect::ALL.into_iter().zip(&mut chosen.aspects) {
        ui.checkbox(on, aspect.name()).on_hover_text(aspect.hint());
    }
    if chosen != plots {
        commands.push(Command::PlotWay(chosen));
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
        let at = cursor_s.and_then(|cursor_s| self.aspect.of(way?.at(cursor_s)?));
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

/// What stored values are multiplied by to be shown, and the unit that they have then.
fn shown_in(aspect: Aspect, units: Units) -> (f64, &'static str) {
    match aspect {
        Aspect::Height => (units.length.per_metre(), units.length.name()),
        Aspect::Speed => (1.0, "m/s"),
        Aspect::Heading | Aspect::Roll | Aspect::Pitch => {
            (units.angle.per_radian(), units.angle.name())
        }
        Aspect::PositionSigma => (1e3, "mm"),
        Aspect::TurnSigma => (units.angle.small_per_radian(), units.angle.small_name()),
    }
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
            let half = HALF_95 * at.sigma;
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

/// How far off one estimate is, over what the ground truth leaves open; spans in which somebody is wrong are shaded.
fn show_errors(
    ui: &mut egui::Ui,
    (open, times): (&OpenDeployment, &Times),
    strip: &Strip,
    (place, one): (usize, &Judged),
    commands: &mut Commands,
) {
    let span_s = times.window_s.map(|since_s| since_s + times.start_s);
    let errors = &one.errors[..];
    let from = errors.partition_point(|error| error.time_s < span_s[0]).saturating_sub(1);
    let to = errors.partition_point(|error| error.time_s <= span_s[1]);
    let seen = &errors[from..errors.len().min(to + 1).max(from)];
    let stride = ((CORNER * seen.len() as f32 / strip.plot.width().max(100.0)) as usize).max(1);
    let pieces: Vec<Vec<ErrorCorner>> = seen
        .chunk_by(|a, b| b.time_s - a.time_s <= GAP_S)
        .map(|piece| piece.chunks(stride).map(|some| ErrorCorner::of(some, times)).collect())
        .collect();
    let greatest = pieces.iter().flatten().map(|corner| corner.most_mm).fold(0.0, f64::max);
    let scale = times.scale;
    let name = one.estimate.name.clone();
    let plot = Plot::new(("errors", open.id, place)).y_grid_spacer(close_marks).label_formatter(
        move |position| match position {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                let time = scale.text_and_seconds(position.x, 1);
                Some(format!("{plot_name}\n{time}\n{:.1} mm", position.y))
            }
            HoverPosition::Elsewhere { .. } => None,
        },
    );
    let dark = ui.visuals().dark_mode;
    let colour = theme::readable(palette::estimate(place), dark);
    let title = format!("position errors of {name} over time");
    let greatest = greatest.max(LEAST_ERROR_MM);
    // The zero stands above the number at the end of the strip below.
    let y_bounds = [-0.06 * greatest, 1.08 * greatest];
    let time_plot = TimePlot { strip, name: &title, times, y_bounds };
    let shades = [true, false].map(|estimate| shades(one, times.start_s, estimate));
    let line_name = name.clone();
    let shown =
        time_plot.show(ui, plot, strip.value_axis("error", "mm"), commands, move |plot_ui| {
            shades.into_iter().for_each(|shade| plot_ui.add(shade));
            for piece in pieces {
                add_errors(plot_ui, &piece, &line_name, colour, theme::faint(dark));
            }
        });
    shown.paint_times(ui, times);
    shown.on_click(times, commands, |_| None);
    let at = open.timeline.cursor_s.and_then(|cursor_s| {
        let after = errors.partition_point(|error| error.time_s < cursor_s);
        errors.get(after).filter(|error| error.time_s - cursor_s < GAP_S)
    });
    let at = at.map_or("nothing at the cursor".to_owned(), |error| {
        let sigma_mm = 1e3 * error.sigma_m();
        let error_mm = 1e3 * error.position_m.norm();
        format!("at the cursor {error_mm:.1} mm (ground truth σ {sigma_mm:.1} mm)")
    });
    let strong =
        RichText::new(name).color(theme::readable(palette::estimate(place), dark)).strong();
    let rmse = RichText::new(format!("rmse {:.1} mm", 1e3 * one.position.rmse));
    let hint = "Line: length of the position error, of several their rms; about it from the least to the greatest. Grey: 1.96 σ of the ground truth along an axis; errors within it \
                cannot be told from none. Shaded red: the estimate is wrong; blue: the ground truth is.";
    strip.words(ui, &[strong, rmse, RichText::new(at)], hint);
}

/// Spans in which the estimate is wrong, or the ground truth.
fn shades(one: &Judged, start_s: f64, estimate: bool) -> Shades {
    let of = |odd_one: OddOne| (odd_one == OddOne::Estimate) == estimate;
    let spans = one.odd.iter().filter(|span| of(span.odd_one));
    let since = |time_s: f64| time_s - start_s;
    let spans =
        spans.map(|span| Interval { start_s: since(span.span_s[0]), end_s: since(span.span_s[1]) });
    let colour = if estimate { palette::METRICS[1] } else { palette::METRICS[0] };
    Shades::new(spans.collect(), theme::rgb(colour).gamma_multiply(0.35))
}

/// One place of the line of an estimate's errors, which may sum up several (s, mm).
struct ErrorCorner {
    x: f64,
    rms_mm: f64,
    least_mm: f64,
    most_mm: f64,
    /// Half the width of the ground truth's 95 % region along an axis.
    open_mm: f64,
}

impl ErrorCorner {
    fn of(some: &[EpochError], times: &Times) -> Self {
        let all_mm = || some.iter().map(|error| 1e3 * error.position_m.norm());
        let mean = |sum: f64| sum / some.len() as f64;
        let variance = some.iter().map(|error| error.sigma_m().powi(2)).sum();
        Self {
            x: some[some.len() / 2].time_s - times.start_s,
            rms_mm: mean(all_mm().map(|mm| mm * mm).sum()).sqrt(),
            least_mm: all_mm().fold(f64::INFINITY, f64::min),
            most_mm: all_mm().fold(0.0, f64::max),
            open_mm: 1e3 * HALF_95 * mean(variance).sqrt(),
        }
    }
}

/// A piece of an error's line over the ground truth's band.
fn add_errors(
    plot_ui: &mut PlotUi<'_>,
    piece: &[ErrorCorner],
    name: &str,
    colour: Color32,
    grey: Color32,
) {
    let of = |value: fn(&ErrorCorner) -> f64| piece.iter().map(value).collect::<Vec<f64>>();
    let x = of(|corner| corner.x);
    let around = FilledArea::new("", &x, &of(|c| c.least_mm), &of(|c| c.most_mm));
    plot_ui.add(around.fill_color(colour.gamma_multiply(0.3)).allow_hover(false));
    let open = FilledArea::new("", &x, &vec![0.0; x.len()], &of(|c| c.open_mm));
    plot_ui.add(open.fill_color(grey.gamma_multiply(0.6)).allow_hover(false));
    let points = piece.iter().map(|c| PlotPoint::new(c.x, c.rms_mm)).collect();
    plot_ui.line(Line::new(name, PlotPoints::Owned(points)).color(colour).width(1.4));
}
