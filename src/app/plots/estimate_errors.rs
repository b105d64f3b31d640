//! Errors of other systems' trajectories, one strip per trajectory, over the uncertainty of the ground truth.
//!
//! The horizontal axis is time, or the driven distance, as is usual for odometry errors.

use egui::{Color32, RichText};
use egui_plot::{AxisHints, FilledArea, HoverPosition, Line, Plot, PlotPoint, PlotPoints, PlotUi};

use super::quads::Shades;
use super::strips::Strip;
use super::time_plot::{TimePlot, still};
use super::times::Times;
use super::{close_marks, round_marks};
use crate::app::model::{Commands, OpenDeployment, TimeCommand};
use crate::app::state::State;
use crate::app::theme;
use resect_core::pipeline::Interval;
use resect_core::statistics::tables::NORMAL_95;
use resect_tools::estimates::Judged;
use resect_tools::estimates::errors::{EpochError, driven_m};
use resect_tools::palette;

/// Least range of the error axis, for errors that are all zero (mm).
const LEAST_ERROR_MM: f64 = 1e-3;
/// Width that one corner of an error line summarises (points).
const CORNER: f32 = 3.0;
/// An error line has a break where ground truth is missing for longer than this (s).
const GAP_S: f64 = 1.0;

/// Draws the errors of each evaluated estimate, with its colour number, and shades the spans in which the estimate or the ground truth is
/// wrong.
pub fn show(
    ui: &mut egui::Ui,
    state: &State,
    (open, times): (&OpenDeployment, &Times),
    strips: &[Strip],
    judged: &[(usize, &Judged)],
    commands: &mut Commands,
) {
    let plots = &state.time.plots;
    let lines: Vec<ErrorLine> = judged
        .iter()
        .zip(strips)
        .map(|((_, one), strip)| ErrorLine::of(one, times, strip.plot.width(), plots.by_distance))
        .collect();
    let greatest_of_all = lines.iter().map(ErrorLine::greatest_mm).fold(0.0, f64::max);
    for ((strip, (colour, one)), line) in strips.iter().zip(judged).zip(lines) {
        let greatest = if plots.one_scale { greatest_of_all } else { line.greatest_mm() };
        let dark = ui.visuals().dark_mode;
        let strip = ErrorStrip {
            open,
            times,
            strip,
            one,
            colour: theme::readable(palette::estimate(*colour), dark),
            grey: theme::faint(dark),
            greatest_mm: greatest.max(LEAST_ERROR_MM),
        };
        if plots.by_distance {
            strip.show_by_distance(ui, line, commands);
        } else {
            strip.show_by_time(ui, line, commands);
        }
        strip.words(ui);
    }
}

/// The errors of one estimate as a line over time or driven distance.
struct ErrorLine {
    /// Segments without gaps.
    pieces: Vec<Vec<ErrorCorner>>,
    /// Driven distance at each error (m); `None` over time.
    driven_m: Option<Vec<f64>>,
}

impl ErrorLine {
    fn of(one: &Judged, times: &Times, width: f32, by_distance: bool) -> Self {
        let span_s = times.window_s.map(|since_s| since_s + times.start_s);
        let errors = &one.errors[..];
        let from = errors.partition_point(|error| error.time_s < span_s[0]).saturating_sub(1);
        let to = errors.partition_point(|error| error.time_s <= span_s[1]);
        let to = errors.len().min(to + 1).max(from);
        let driven_m = by_distance.then(|| driven_m(errors));
        let stride = ((CORNER * (to - from) as f32 / width.max(100.0)) as usize).max(1);
        let x = |index: usize| match &driven_m {
            Some(driven_m) => driven_m[index],
            None => errors[index].time_s - times.start_s,
        };
        let mut pieces = Vec::new();
        let mut first = from;
        for piece in errors[from..to].chunk_by(|a, b| b.time_s - a.time_s <= GAP_S) {
            let corners = piece.chunks(stride).enumerate();
            let corner = |(k, some): (usize, &[EpochError])| {
                ErrorCorner::of(some, x(first + k * stride + some.len() / 2))
            };
            pieces.push(corners.map(corner).collect());
            first += piece.len();
        }
        Self { pieces, driven_m }
    }

    fn greatest_mm(&self) -> f64 {
        self.pieces.iter().flatten().map(|corner| corner.most_mm).fold(0.0, f64::max)
    }
}

/// The strip of one estimate.
struct ErrorStrip<'a> {
    open: &'a OpenDeployment,
    times: &'a Times,
    strip: &'a Strip,
    one: &'a Judged,
    colour: Color32,
    grey: Color32,
    greatest_mm: f64,
}

impl ErrorStrip<'_> {
    /// Bounds of the errors (mm), with zero above the number at the end of the strip below.
    fn y_bounds(&self) -> [f64; 2] {
        [-0.06 * self.greatest_mm, 1.08 * self.greatest_mm]
    }

    fn axis<'a>(&self) -> AxisHints<'a> {
        self.strip.value_axis("error", "mm")
    }

    fn show_by_time(&self, ui: &mut egui::Ui, line: ErrorLine, commands: &mut Commands) {
        let Self { open, times, strip, one, colour, grey, .. } = *self;
        let (scale, name) = (times.scale, one.estimate.name.clone());
        let plot = Plot::new(("errors", open.id, &name))
            .y_grid_spacer(close_marks)
            .label_formatter(move |position| said_at(position, |x| scale.text_and_seconds(x, 1)));
        let title = format!("position errors of {name} over time");
        let time_plot = TimePlot { strip, name: &title, times, y_bounds: self.y_bounds() };
        let since = |time_s: f64| time_s - times.start_s;
        let shades = [true, false].map(|estimate| shades(one, since, estimate));
        let shown = time_plot.show(ui, plot, self.axis(), commands, move |plot_ui| {
            shades.into_iter().for_each(|shade| plot_ui.add(shade));
            for piece in line.pieces {
                add_errors(plot_ui, &piece, &name, colour, grey);
            }
        });
        shown.paint_times(ui, times);
        shown.on_click(times, commands, |_| None);
    }

    /// Shows the errors over the distance driven in the time window; a click moves the cursor to the time at that distance.
    fn show_by_distance(&self, ui: &mut egui::Ui, line: ErrorLine, commands: &mut Commands) {
        let Self { open, times, strip, one, colour, grey, .. } = *self;
        let errors = &one.errors;
        let Some(driven_m) = line.driven_m.filter(|driven_m| !driven_m.is_empty()) else { return };
        let at = |time_s: f64| {
            let after = errors.partition_point(|error| error.time_s < time_s);
            driven_m[after.min(driven_m.len() - 1)]
        };
        let [from_m, to_m] = times.window_s.map(|since_s| at(since_s + times.start_s));
        let name = one.estimate.name.clone();
        let x_axis = strip.axis_below("driven (m)");
        let y_bounds = self.y_bounds();
        let plot = still(Plot::new(("errors by distance", open.id, &name)))
            .width(strip.plot.width())
            .height(strip.plot.height())
            .custom_x_axes(x_axis.into_iter().collect())
            .custom_y_axes(vec![self.axis()])
            .x_grid_spacer(round_marks)
            .y_grid_spacer(close_marks)
            .label_formatter(|position| said_at(position, |x| format!("{x:.1} m driven")));
        let title = format!("position errors of {name} over the driven way");
        let shades = [true, false].map(|estimate| shades(one, at, estimate));
        let builder = egui::UiBuilder::new().id_salt(&title).max_rect(strip.plot);
        let shown = plot.show(&mut ui.new_child(builder), move |plot_ui| {
            plot_ui.set_plot_bounds_x(from_m..=to_m.max(from_m + 1e-3));
            plot_ui.set_plot_bounds_y(y_bounds[0]..=y_bounds[1]);
            shades.into_iter().for_each(|shade| plot_ui.add(shade));
            for piece in line.pieces {
                add_errors(plot_ui, &piece, &name, colour, grey);
            }
        });
        let (response, transform) = (shown.response, shown.transform);
        let role = egui::accesskit::Role::Canvas;
        response.widget_info(|| egui::WidgetInfo::labeled(role, ui.is_enabled(), &title));
        if let Some(cursor_s) = open.timeline.cursor_s {
            let x = transform.position_from_point_x(at(cursor_s));
            let cursor = theme::rgb(theme::cursor(ui.visuals().dark_mode));
            let painter = ui.painter().with_clip_rect(*transform.frame());
            painter.vline(x, transform.frame().y_range(), egui::Stroke::new(1.0, cursor));
        }
        if response.clicked()
            && let Some(pointer) = response.interact_pointer_pos()
        {
            let wanted_m = transform.value_from_position(pointer).x;
            let there = driven_m.partition_point(|m| *m < wanted_m).min(errors.len() - 1);
            commands.push(TimeCommand::MoveCursor(errors[there].time_s).into());
        }
    }

    /// Shows the name of the estimate, its overall error, and its error at the cursor.
    fn words(&self, ui: &mut egui::Ui) {
        let errors = &self.one.errors;
        let at = self.open.timeline.cursor_s.and_then(|cursor_s| {
            let after = errors.partition_point(|error| error.time_s < cursor_s);
            errors.get(after).filter(|error| error.time_s - cursor_s < GAP_S)
        });
        let at = at.map_or("no value at the cursor".to_owned(), |error| {
            let error_mm = 1e3 * error.position_m.norm();
            match (self.strip.is_tight(), error.sigma_m().map(|sigma_m| 1e3 * sigma_m)) {
                (true, Some(sigma_mm)) => {
                    format!("cursor {error_mm:.1}\u{a0}mm (σ\u{a0}{sigma_mm:.1})")
                }
                (true, None) => format!("cursor {error_mm:.1}\u{a0}mm"),
                (false, Some(sigma_mm)) => {
                    format!("at the cursor {error_mm:.1} mm (ground truth σ {sigma_mm:.1} mm)")
                }
                (false, None) => format!("at the cursor {error_mm:.1} mm"),
            }
        });
        let name = RichText::new(&self.one.estimate.name).color(self.colour).strong();
        let rmse = RichText::new(format!("rmse {:.1} mm", 1e3 * self.one.position.rmse));
        let hint = "Line: position error, or the rms of several; band: from the least to the greatest. Grey: 1.96 σ of the ground truth along an axis; errors within it \
                    are not significant. Shaded red: the estimate is wrong. Shaded blue: the ground truth is wrong.";
        self.strip.words(ui, &[name, rmse, RichText::new(at)], hint);
    }
}

/// Text beside the pointer.
fn said_at(position: &HoverPosition<'_>, x: impl Fn(f64) -> String) -> Option<String> {
    match position {
        HoverPosition::NearDataPoint { plot_name, position, .. } => {
            Some(format!("{plot_name}\n{}\n{:.1} mm", x(position.x), position.y))
        }
        HoverPosition::Elsewhere { .. } => None,
    }
}

/// Spans in which the estimate, or the ground truth, is wrong; `place` maps times to the axis.
fn shades(one: &Judged, place: impl Fn(f64) -> f64, estimate: bool) -> Shades {
    let spans = one.odd.iter().filter(|span| span.odd_one.is_of_truth() != estimate);
    let spans =
        spans.map(|span| Interval { start_s: place(span.span_s[0]), end_s: place(span.span_s[1]) });
    let colour = if estimate { palette::METRICS[1] } else { palette::METRICS[0] };
    Shades::new(spans.collect(), theme::rgb(colour).gamma_multiply(0.35))
}

/// A point of an error line, which may summarise several errors: position on the axis (s, or m driven), and errors (mm).
struct ErrorCorner {
    x: f64,
    rms_mm: f64,
    least_mm: f64,
    most_mm: f64,
    /// Half-width of the ground truth's 95 % region along an axis (mm).
    open_mm: f64,
}

impl ErrorCorner {
    fn of(some: &[EpochError], x: f64) -> Self {
        let all_mm = || some.iter().map(|error| 1e3 * error.position_m.norm());
        let mean = |sum: f64| sum / some.len() as f64;
        let variance = some.iter().map(|error| error.sigma_m().unwrap_or_default().powi(2)).sum();
        Self {
            x,
            rms_mm: mean(all_mm().map(|mm| mm * mm).sum()).sqrt(),
            least_mm: all_mm().fold(f64::INFINITY, f64::min),
            most_mm: all_mm().fold(0.0, f64::max),
            open_mm: 1e3 * NORMAL_95 * mean(variance).sqrt(),
        }
    }
}

/// Draws a segment of an error line over the ground truth's band.
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
