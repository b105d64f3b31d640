//! One plot of one or more channels, with one or two axes of values.

use egui::{Color32, FontId, RichText, Stroke};
use egui_plot::{AxisHints, HoverPosition, Plot, PlotPoint, PlotUi};

use super::value_scale::ValueScale;
use crate::app::model::channel_plots::{SeenSeries, SharedPlot};
use crate::app::model::estimates::Shown;
use crate::app::model::{ChannelPlots, Commands, Horizontal, OpenDeployment, Units};
use crate::app::plots::bands::Bands;
use crate::app::plots::dimension_units::{per_stored, unit, with_unit};
use crate::app::plots::marks::Marks;
use crate::app::plots::strips::Strip;
use crate::app::plots::time_plot::TimePlot;
use crate::app::plots::times::Times;
use crate::app::plots::{LABELS, close_marks, round_marks, with_room};
use crate::app::prepared::channels::{Channel, Subject};
use crate::app::prepared::series::Corner;
use crate::app::state::State;
use crate::app::theme;
use resect_core::pipeline::SampleFate;
use resect_tools::palette;

/// Fewest corners of a line.
const LEAST_CORNERS: usize = 100;
/// Fewest runs to which a series is reduced; a series of up to three times as many dots is drawn completely.
const LEAST_RUNS: usize = 800;
/// Extent of the crosses of a second channel, and of readings that are not used (points).
const CROSS: f32 = 2.2;
const FATE_CROSS: f32 = 3.2;

/// A series of a channel in its plot.
pub struct DrawnSeries<'a> {
    pub channel: Channel,
    /// True on the right axis.
    pub right: bool,
    /// Place of the channel in the plot, which determines its mark.
    pub order: usize,
    pub seen: SeenSeries<'a>,
    /// Fate of each value; empty for channels without fates.
    pub fates: &'a [SampleFate],
}

pub struct ChannelPlot<'a> {
    pub open: &'a OpenDeployment,
    pub units: Units,
    pub shared: &'a SharedPlot,
    pub plots: &'a ChannelPlots,
    pub times: &'a Times,
    pub all: Vec<DrawnSeries<'a>>,
}

impl<'a> ChannelPlot<'a> {
    /// Collects the visible series of a plot.
    pub fn of(
        state: &'a State,
        open: &'a OpenDeployment,
        shared: &'a SharedPlot,
        times: &'a Times,
    ) -> Self {
        let plots = &state.time.plots;
        let analysis = open.analysis.as_deref().filter(|_| plots.fates);
        let mut all = Vec::new();
        for (order, (channel, right)) in shared.channels().enumerate() {
            for seen in plots.seen(channel, open.sources(), &state.scene.visibility) {
                let fates = analysis
                    .filter(|_| channel.is_of_readings())
                    .map_or(&[][..], |analysis| &analysis.pipeline.fates[seen.subject.1].each);
                all.push(DrawnSeries { channel, right, order, seen, fates });
            }
        }
        Self { open, units: state.workspace.units, shared, plots, times, all }
    }

    /// Returns true if one channel alone is plotted.
    fn is_single(&self) -> bool {
        self.shared.channels().count() == 1
    }

    /// Returns a name of a series that identifies it in this plot.
    fn name(&self, one: &DrawnSeries<'_>) -> String {
        match self.is_single() {
            true => one.seen.name.clone(),
            false => format!("{}, {}", one.channel.name(), one.seen.name),
        }
    }

    /// Returns the factor from a stored value to the value shown.
    fn factor(&self, one: &DrawnSeries<'_>) -> f64 {
        per_stored(one.channel.dimension(), self.units)
    }

    /// Returns the scales of the left and the right axis that show all of these marks; `None` for an axis without channels.
    fn scales(&self, drawn: &[SeriesMarks]) -> [Option<ValueScale>; 2] {
        [false, true].map(|right| {
            let channels = if right { &self.shared.right } else { &self.shared.left };
            let dimension = channels.first()?.dimension();
            let own = self.all.iter().zip(drawn).filter(|(one, _)| one.right == right);
            let values = own.flat_map(|(one, drawn)| {
                let factor = self.factor(one);
                drawn.extents().into_iter().map(move |y| factor * y)
            });
            Some(ValueScale { dimension, bounds: with_room(values) })
        })
    }

    /// Returns a function that describes the point under the pointer, from the plot's coordinates.
    fn hover_text(
        &self,
        scales: [Option<ValueScale>; 2],
        x_text: impl Fn(f64) -> String + 'a,
    ) -> impl Fn(&HoverPosition<'_>) -> Option<String> + 'a {
        let units = self.units;
        let right: Vec<String> =
            self.all.iter().filter(|one| one.right).map(|one| self.name(one)).collect();
        move |position| match position {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                let is_right = right.iter().any(|name| plot_name.starts_with(name.as_str()));
                let left = scales[0]?;
                let own = if is_right { scales[1]? } else { left };
                let stored = own.value_at(position.y, &left) / per_stored(own.dimension, units);
                let value = with_unit(own.dimension, units, stored);
                Some(format!("{plot_name}\n{}\n{value}", x_text(position.x)))
            }
            HoverPosition::Elsewhere { .. } => None,
        }
    }

    fn value_axis<'p>(&self, strip: &Strip) -> AxisHints<'p> {
        let names: Vec<&str> = self.shared.left.iter().map(|channel| channel.name()).collect();
        let unit = self.shared.left.first().map_or("", |it| unit(it.dimension(), self.units));
        strip.value_axis(&names.join(", "), unit)
    }

    pub fn over_time(&self, ui: &mut egui::Ui, strip: &Strip, commands: &mut Commands) {
        let times = self.times;
        let runs = (strip.plot.width() as usize).max(LEAST_RUNS);
        let corners = (strip.plot.width() as usize).max(LEAST_CORNERS);
        let drawn: Vec<SeriesMarks> = (self.all.iter())
            .map(|one| match one.seen.series.has_sigma() {
                true => SeriesMarks::Lines(one.seen.series.lines(times.window_s, corners)),
                false => SeriesMarks::Dots(one.seen.series.over_time(times.window_s, runs)),
            })
            .collect();
        let scales = self.scales(&drawn);
        let Some(left) = scales[0] else { return };
        let scale = times.scale;
        let hover = self.hover_text(scales, move |x| scale.text_and_seconds(x, 2));
        let name = self.plots.name_of(self.shared);
        let plot = Plot::new(("channels", self.open.id, &name))
            .y_grid_spacer(close_marks)
            .label_formatter(move |position| hover(position));
        let time_plot = TimePlot { strip, name: &name, times, y_bounds: left.bounds };
        let axis = self.value_axis(strip);
        let dark = ui.visuals().dark_mode;
        let shown = time_plot.show(ui, plot, axis, commands, |plot_ui| {
            self.add(plot_ui, drawn, scales, dark);
        });
        if let Some(right) = scales[1] {
            right.paint(&shown.painter(ui), shown.frame(), self.units);
        }
        shown.paint_times(ui, times);
        shown.on_click(times, commands, |_| None);
    }

    /// Plots each series against a channel.
    pub fn against(&self, ui: &mut egui::Ui, strip: &Strip, other: Horizontal) {
        let units = self.units;
        let x_factor = per_stored(other.channel.dimension(), units);
        let runs = (strip.plot.width() as usize).max(LEAST_RUNS);
        let drawn: Vec<SeriesMarks> = (self.all.iter())
            .map(|one| {
                let dots = one.seen.against.map_or_else(Vec::new, |other| {
                    one.seen.series.against(&other, self.times.window_s, runs)
                });
                let scaled = dots
                    .into_iter()
                    .map(|(index, dot)| (index, PlotPoint::new(x_factor * dot.x, dot.y)));
                SeriesMarks::Dots(scaled.collect())
            })
            .collect();
        let scales = self.scales(&drawn);
        let Some(left) = scales[0] else { return };
        let x = with_room(drawn.iter().flat_map(SeriesMarks::abscissae));
        let title = format!("{} ({})", other.name(), unit(other.channel.dimension(), units));
        let x_axis = AxisHints::new_x()
            .label(RichText::new(title).small())
            .tick_label_font(FontId::proportional(11.0))
            .label_spacing(LABELS);
        let hover = self.hover_text(scales, move |x| {
            format!(
                "{}: {}",
                other.name(),
                with_unit(other.channel.dimension(), units, x / x_factor)
            )
        });
        let name = self.plots.name_of(self.shared);
        let builder = egui::UiBuilder::new().id_salt(&name).max_rect(strip.plot);
        let ui = &mut ui.new_child(builder);
        let window_s = self.times.window_s.map(f64::to_bits);
        let plot = Plot::new(("channels", self.open.id, &name, window_s))
            .width(strip.plot.width())
            .height(strip.plot.height())
            .custom_x_axes(vec![x_axis])
            .custom_y_axes(vec![self.value_axis(strip)])
            .x_grid_spacer(round_marks)
            .y_grid_spacer(close_marks)
            .label_formatter(move |position| hover(position));
        // Plots of positions have equal scales on both axes, and show all positions.
        let are_places = self.shared.right.is_empty()
            && self.shared.channels().all(|(channel, _)| is_place(channel));
        let plot = if are_places && is_place(other.channel) {
            plot.data_aspect(1.0)
        } else {
            plot.default_x_bounds(x[0], x[1]).default_y_bounds(left.bounds[0], left.bounds[1])
        };
        let dark = ui.visuals().dark_mode;
        let shown = plot.show(ui, |plot_ui| self.add(plot_ui, drawn, scales, dark));
        let role = egui::accesskit::Role::Canvas;
        shown.response.widget_info(|| egui::WidgetInfo::labeled(role, ui.is_enabled(), &name));
        let painter = ui.painter().with_clip_rect(*shown.transform.frame());
        if let Some(right) = scales[1] {
            // The user may have zoomed the plot.
            let bounds = shown.transform.bounds();
            let seen = [bounds.min()[1], bounds.max()[1]].map(|y| right.value_at(y, &left));
            let right = ValueScale { bounds: seen, ..right };
            right.paint(&painter, *shown.transform.frame(), units);
        }
        // Marks the values at the time cursor.
        for one in &self.all {
            let own = scales[usize::from(one.right)].unwrap_or(left);
            let at = self.times.cursor_s.and_then(|cursor_s| {
                let x = x_factor * one.seen.against?.at(cursor_s)?;
                let y = self.factor(one) * one.seen.series.at(cursor_s)?;
                Some(PlotPoint::new(x, own.to_left(y, &left)))
            });
            if let Some(at) = at {
                let stroke = Stroke::new(1.8, theme::rgb(theme::cursor(dark)));
                painter.circle_stroke(shown.transform.position_from_point(&at), 5.0, stroke);
            }
        }
    }

    /// Adds the marks of all series, those of the right axis in the coordinates of the left one.
    fn add(
        &self,
        plot_ui: &mut PlotUi<'_>,
        drawn: Vec<SeriesMarks>,
        scales: [Option<ValueScale>; 2],
        dark: bool,
    ) {
        let Some(left) = scales[0] else { return };
        for (one, drawn) in self.all.iter().zip(drawn) {
            let own = scales[usize::from(one.right)].unwrap_or(left);
            let factor = self.factor(one);
            let place = |stored: f64| own.to_left(factor * stored, &left);
            let (name, colour) = (self.name(one), theme::rgb(colour(one, dark)));
            match drawn {
                SeriesMarks::Lines(lines) => {
                    let placed = |corner: Corner| Corner {
                        since_s: corner.since_s,
                        value: place(corner.value),
                        low: place(corner.low),
                        high: place(corner.high),
                    };
                    let lines =
                        lines.into_iter().map(|line| line.into_iter().map(placed).collect());
                    plot_ui.add(Bands::new(name, lines.collect(), colour));
                }
                SeriesMarks::Dots(dots) => {
                    let mut by_fate: Vec<(SampleFate, Vec<PlotPoint>)> =
                        SampleFate::ALL.map(|fate| (fate, Vec::new())).into();
                    for (index, dot) in dots {
                        let fate = one.fates.get(index).copied().unwrap_or(SampleFate::Kept);
                        let of_fate = by_fate.iter_mut().find(|(known, _)| *known == fate);
                        let dot = PlotPoint::new(dot.x, place(dot.y));
                        of_fate.into_iter().for_each(|(_, dots)| dots.push(dot));
                    }
                    for (fate, dots) in by_fate.into_iter().filter(|(_, dots)| !dots.is_empty()) {
                        plot_ui.add(marks(&name, dots, (fate, colour), one.order));
                    }
                }
            }
        }
    }

    /// Shows the value at the cursor, with σ if it has one, and for readings and triplets the number of values.
    pub fn words(&self, ui: &mut egui::Ui, strip: &Strip) {
        let dark = ui.visuals().dark_mode;
        let mut lines = Vec::new();
        for (order, (channel, right)) in self.shared.channels().enumerate() {
            let own = self.all.iter().filter(|one| one.order == order);
            let heading = heading(channel, right, order, self.is_single());
            let mut first = Some(RichText::new(heading).strong());
            for one in own {
                let has_sigma = one.seen.series.has_sigma();
                if has_sigma || !self.is_single() {
                    lines.extend(first.take());
                }
                let text = RichText::new(match has_sigma {
                    true => self.vehicle_at_cursor(channel),
                    false => self.at_cursor(one),
                });
                let own = theme::readable(colour(one, dark), dark);
                lines.push(if has_sigma && self.is_single() { text } else { text.color(own) });
            }
        }
        let mut hints = self.shared.channels().map(|(channel, _)| channel.describe().hint);
        let hint = if self.is_single() { hints.next().unwrap_or_default() } else { "" };
        strip.words(ui, &lines, hint);
    }

    fn at_cursor(&self, one: &DrawnSeries<'_>) -> String {
        let count = one.seen.series.count(self.times.window_s);
        let at = self.times.cursor_s.and_then(|cursor_s| one.seen.series.at(cursor_s));
        let at = at.map(|value| with_unit(one.channel.dimension(), self.units, value));
        let at = at.unwrap_or_else(|| "no value".to_owned());
        format!("{}: {count} values; at the cursor {at}", one.seen.name)
    }

    fn vehicle_at_cursor(&self, channel: Channel) -> String {
        let at = || {
            let instant = self.open.way.newest.as_deref()?.at(self.open.timeline.cursor_s?)?;
            channel.of_vehicle(&instant)
        };
        let dimension = channel.dimension();
        let (factor, unit) = (per_stored(dimension, self.units), unit(dimension, self.units));
        match at() {
            None => "not determined at the cursor".to_owned(),
            Some(at) if at.sigma > 0.0 => {
                Shown::new(factor * at.value, Some(factor * at.sigma), unit, 3).in_words()
            }
            Some(at) => format!("{:.2} {unit}", factor * at.value),
        }
    }
}

/// Returns the name of a channel beside its plot, with its mark and its axis if it shares the plot.
fn heading(channel: Channel, right: bool, order: usize, is_single: bool) -> String {
    let name = channel.name();
    if is_single {
        return name.to_owned();
    }
    let is_line = channel.subject() == Subject::Vehicle;
    let mark = match order {
        _ if is_line => "—",
        0 => "•",
        _ => "×",
    };
    let axis = if right { "right" } else { "left" };
    format!("{mark} {name} ({axis})")
}

/// The dots or the lines of a series, in the stored unit.
enum SeriesMarks {
    /// Each with the index of its value.
    Dots(Vec<(usize, PlotPoint)>),
    Lines(Vec<Vec<Corner>>),
}

impl SeriesMarks {
    /// Returns values whose least and greatest are the bounds.
    fn extents(&self) -> Vec<f64> {
        match self {
            Self::Dots(dots) => dots.iter().map(|(_, dot)| dot.y).collect(),
            Self::Lines(lines) => {
                lines.iter().flatten().flat_map(|corner| [corner.low, corner.high]).collect()
            }
        }
    }

    fn abscissae(&self) -> Vec<f64> {
        match self {
            Self::Dots(dots) => dots.iter().map(|(_, dot)| dot.x).collect(),
            Self::Lines(lines) => lines.iter().flatten().map(|corner| corner.since_s).collect(),
        }
    }
}

/// Returns dots for the first channel and crosses for others; readings that are not used have crosses in the colour of their fate.
fn marks(
    name: &str,
    dots: Vec<PlotPoint>,
    (fate, colour): (SampleFate, Color32),
    order: usize,
) -> Marks {
    if fate == SampleFate::Kept {
        return match order {
            0 => Marks::dots(name, dots, colour),
            _ => Marks::crosses(name, dots, colour, CROSS),
        };
    }
    let name = format!("{name}, {}", fate.label());
    let colour = theme::rgb(palette::fate(fate)).gamma_multiply(0.7);
    Marks::crosses(name, dots, colour, FATE_CROSS)
}

/// Returns the colour of a series: that of its station or pair, lighter or darker for further channels of the plot.
fn colour(one: &DrawnSeries<'_>, dark: bool) -> palette::Rgb {
    let own = match one.seen.subject {
        (Subject::Station, station) => palette::station(station),
        (Subject::Pair, pair) => palette::pair(pair),
        (Subject::Prism1, _) => palette::station(0),
        (Subject::Vehicle, _) => palette::METRICS[one.order % palette::METRICS.len()],
    };
    let lines = if one.seen.subject.0 == Subject::Vehicle { palette::METRICS.len() } else { 1 };
    let share = (0.35 * (one.order / lines) as f32).min(0.7);
    let end = if dark { 255.0 } else { 0.0 };
    own.map(|channel| (f32::from(channel) + share * (end - f32::from(channel))) as u8)
}

fn is_place(channel: Channel) -> bool {
    matches!(channel, Channel::X | Channel::Y | Channel::Height)
}
