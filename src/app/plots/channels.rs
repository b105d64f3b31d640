//! Channels over time or against another channel, one strip each, with errors of other systems' trajectories above them.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Color32, FontId, PopupCloseBehavior, RichText, Stroke};
use egui_plot::{AxisHints, HoverPosition, Plot, PlotPoint, PlotUi};

use super::bands::Bands;
use super::dimension_units::{per_stored, unit, with_unit};
use super::estimate_errors;
use super::marks::Marks;
use super::strips::{Strip, strips};
use super::time_plot::{self, TimePlot};
use super::times::Times;
use super::{
    LABELS, close_marks, in_the_middle, pair_switches, round_marks, station_switches, with_room,
};
use crate::app::model::channel_plots::{APART, SeenSeries};
use crate::app::model::estimates::Shown;
use crate::app::model::{ChannelPlots, Commands, OpenDeployment, TimeCommand, Units};
use crate::app::prepared::channels::{Channel, Subject};
use crate::app::prepared::series::Corner;
use crate::app::state::State;
use crate::app::theme;
use resect_core::estimates::Judged;
use resect_core::palette;
use resect_core::palette::Rgb;

/// Room for the text beside the box that chooses the horizontal axis (points).
const BESIDE_BOX: f32 = 60.0;
/// Narrower panes show the choice of channels and the switches of their series on separate lines (points).
const NARROW: f32 = 640.0;
/// Fewest corners of a line.
const LEAST_CORNERS: usize = 100;
/// Fewest runs to which a series is reduced; a series of up to three times as many dots is drawn completely.
const LEAST_RUNS: usize = 800;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let Some((open, _)) = state.analysed() else {
        in_the_middle(ui, "Nothing open.");
        return;
    };
    if state.is_stale() {
        ui.multiply_opacity(0.45);
    }
    let times = Times::of(open, state);
    let plots = state.time.plots;
    let channels: Vec<Channel> = plots.channels().collect();
    heads(ui, state, (open, &times), commands);
    let judged: Vec<(usize, &Judged)> =
        if plots.errors { open.judging.judged().collect() } else { Vec::new() };
    if judged.is_empty() && channels.is_empty() {
        in_the_middle(ui, nothing_shown(open, plots));
        return;
    }
    let sources = open.sources();
    let seen: Vec<Vec<SeenSeries<'_>>> = (channels.iter())
        .map(|channel| plots.seen(*channel, sources, &state.scene.visibility))
        .collect();
    let lines = seen.iter().map(Vec::len).max().unwrap_or(0).max(2);
    let places = strips(ui, judged.len() + channels.len(), lines);
    let (of_errors, of_channels) = places.split_at(judged.len());
    estimate_errors::show(ui, state, (open, &times), of_errors, &judged, commands);
    for ((strip, channel), all) in of_channels.iter().zip(channels).zip(seen) {
        let units = state.workspace.units;
        let plot = ChannelPlot { open, units, channel, plots, times: &times, all };
        if plot.all.is_empty() {
            strip.words(ui, &[RichText::new(channel.name()).strong()], "");
            let builder = egui::UiBuilder::new().id_salt(channel.name()).max_rect(strip.plot);
            in_the_middle(&mut ui.new_child(builder), nothing(open, plots, channel));
            continue;
        }
        match plots.against {
            None => plot.over_time(ui, strip, commands),
            Some(other) => plot.against(ui, strip, other),
        }
        plot.words(ui, strip);
    }
}

/// Shows the choice of channels and the switches of their series, in one line or two.
fn heads(
    ui: &mut egui::Ui,
    state: &State,
    (open, times): (&OpenDeployment, &Times),
    commands: &mut Commands,
) {
    let plots = state.time.plots;
    let can_judge = !open.judging.added.is_empty();
    let has_channels = plots.channels().next().is_some();
    let shows = |subject: Subject| plots.channels().any(|channel| channel.subject() == subject);
    let has_switches = shows(Subject::Station) || shows(Subject::Pair);
    let is_narrow = has_switches && ui.available_width() < NARROW;
    let picturing = state.workspace.picturing;
    if is_narrow && !picturing {
        time_plot::head(ui, |ui| choice(ui, plots, can_judge, commands));
    }
    time_plot::head(ui, |ui| {
        if !is_narrow && !picturing {
            choice(ui, plots, can_judge, commands);
        }
        if shows(Subject::Station) {
            station_switches(ui, state, commands);
        }
        if shows(Subject::Pair) {
            pair_switches(ui, state, commands);
        }
        if has_channels && !picturing {
            let button = ui.small_button("Save as CSV…");
            let hint = "All values of the shown channels, not only the drawn ones";
            if button.on_hover_text(hint).clicked() {
                commands.push(TimeCommand::SaveChannelsDialog.into());
            }
        }
        time_plot::selection(ui, state, times, commands);
        let is_over_time = plots.against.is_none() && has_channels;
        if is_over_time || (plots.errors && !plots.by_distance) {
            time_plot::hint(ui, state, "");
        }
    });
}

/// Reason why the pane is empty.
fn nothing_shown(open: &OpenDeployment, plots: ChannelPlots) -> &'static str {
    match open.judging.judgement.is_running() {
        true => "Evaluating…",
        false if plots.errors && !open.judging.added.is_empty() => {
            "No trajectory could be evaluated: see the Evaluation pane."
        }
        false => "No channel selected: choose one under Show…",
    }
}

/// Reason why a channel has no series.
fn nothing(open: &OpenDeployment, plots: ChannelPlots, channel: Channel) -> &str {
    let both = [Some(channel), plots.against];
    let is_one_of = |some: &[Channel]| both.iter().flatten().any(|own| some.contains(own));
    let is_vehicle = both.iter().flatten().any(|own| own.subject() == Subject::Vehicle);
    let way = open.way.newest.as_deref();
    if is_vehicle {
        way.and_then(|way| way.why_not.as_deref()).unwrap_or("Not determined by this result.")
    } else if is_one_of(&[Channel::OwnClock]) {
        "No station clocks in these files."
    } else if is_one_of(&[Channel::X, Channel::Y, Channel::Height]) {
        "The station positions are not determined, or all are hidden."
    } else {
        "The data has no such values, or all are hidden."
    }
}

/// Lets the user choose the channels, their horizontal axis, and the plots of errors.
fn choice(ui: &mut egui::Ui, plots: ChannelPlots, can_judge: bool, commands: &mut Commands) {
    let mut chosen = plots;
    let stays = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    MenuButton::new("Show…").config(stays).ui(ui, |ui| {
        if can_judge {
            error_switches(ui, &mut chosen);
            ui.separator();
        }
        for (index, channel) in Channel::ALL.into_iter().enumerate() {
            if index == Channel::OF_VEHICLE {
                ui.separator();
            }
            let mut on = plots.shows(channel);
            let name = if index < Channel::OF_VEHICLE {
                format!("vehicle: {}", channel.name())
            } else {
                channel.name().to_owned()
            };
            if ui.checkbox(&mut on, name).on_hover_text(channel.describe().hint).clicked() {
                chosen = chosen.toggled(channel);
            }
        }
    });
    if plots.channels().next().is_some() {
        against(ui, plots, &mut chosen);
    }
    if chosen != plots {
        commands.push(TimeCommand::Plot(chosen).into());
    }
}

/// Lets the user choose the channel on the horizontal axis of all others.
fn against(ui: &mut egui::Ui, plots: ChannelPlots, chosen: &mut ChannelPlots) {
    ui.small("against");
    let width = (ui.available_width() - BESIDE_BOX).clamp(40.0, 130.0);
    let against = plots.against.map_or("time", Channel::name);
    let combo = egui::ComboBox::from_id_salt("against").selected_text(against);
    let combo = combo.width(width).truncate().height(400.0).show_ui(ui, |ui| {
        if ui.selectable_label(plots.against.is_none(), "time").clicked() {
            chosen.against = None;
        }
        for channel in Channel::ALL {
            let possible = plots.goes_against(channel);
            let on = plots.against == Some(channel);
            let entry = ui.add_enabled(possible, egui::Button::selectable(on, channel.name()));
            let entry = entry.on_disabled_hover_text(APART);
            if entry.on_hover_text(channel.describe().hint).clicked() {
                chosen.against = Some(channel);
            }
        }
    });
    let name = "Plotted against";
    combo.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, name));
}

fn error_switches(ui: &mut egui::Ui, chosen: &mut ChannelPlots) {
    ui.checkbox(&mut chosen.errors, "errors")
        .on_hover_text("Errors of each added trajectory, with the σ of the ground truth");
    ui.add_enabled_ui(chosen.errors, |ui| {
        ui.checkbox(&mut chosen.by_distance, "by distance")
            .on_hover_text("Errors over the driven distance instead of time");
        ui.checkbox(&mut chosen.one_scale, "one scale")
            .on_hover_text("All errors on the same scale");
    });
}

struct ChannelPlot<'a> {
    open: &'a OpenDeployment,
    units: Units,
    channel: Channel,
    plots: ChannelPlots,
    times: &'a Times,
    all: Vec<SeenSeries<'a>>,
}

impl ChannelPlot<'_> {
    fn over_time(&self, ui: &mut egui::Ui, strip: &Strip, commands: &mut Commands) {
        let (channel, units, times) = (self.channel, self.units, self.times);
        let (scale, factor) = (times.scale, per_stored(channel.dimension(), units));
        let runs = (strip.plot.width() as usize).max(LEAST_RUNS);
        let corners = (strip.plot.width() as usize).max(LEAST_CORNERS);
        let drawn: Vec<SeriesMarks> = (self.all.iter())
            .map(|one| match one.series.has_sigma() {
                true => SeriesMarks::Lines(one.series.lines(times.window_s, corners)),
                false => SeriesMarks::Dots(one.series.over_time(times.window_s, runs)),
            })
            .collect();
        let y_bounds = with_room(drawn.iter().flat_map(SeriesMarks::extents).map(|y| factor * y));
        let plot = Plot::new(("channels", self.open.id, channel.name()))
            .y_grid_spacer(close_marks)
            .label_formatter(move |position| match position {
                HoverPosition::NearDataPoint { plot_name, position, .. } => {
                    let time = scale.text_and_seconds(position.x, 2);
                    let value = with_unit(channel.dimension(), units, position.y / factor);
                    Some(format!("{plot_name}\n{time}\n{value}"))
                }
                HoverPosition::Elsewhere { .. } => None,
            });
        let axis = strip.value_axis(channel.name(), unit(channel.dimension(), units));
        let name = self.plots.name_of(channel);
        let time_plot = TimePlot { strip, name: &name, times, y_bounds };
        let shown = time_plot.show(ui, plot, axis, commands, |plot_ui| {
            for (one, drawn) in self.all.iter().zip(drawn) {
                drawn.add(plot_ui, &one.name, theme::rgb(colour(one)), factor);
            }
        });
        shown.paint_times(ui, times);
        shown.on_click(times, commands, |_| None);
    }

    fn against(&self, ui: &mut egui::Ui, strip: &Strip, other: Channel) {
        let (channel, units) = (self.channel, self.units);
        let factors = [other, channel].map(|channel| per_stored(channel.dimension(), units));
        let runs = (strip.plot.width() as usize).max(LEAST_RUNS);
        let dots: Vec<Vec<PlotPoint>> = (self.all.iter())
            .filter_map(|one| Some((one, one.against?)))
            .map(|(one, other)| {
                let dots = one.series.against(&other, self.times.window_s, runs).into_iter();
                dots.map(|dot| PlotPoint::new(factors[0] * dot.x, factors[1] * dot.y)).collect()
            })
            .collect();
        let [x, y] = [0, 1].map(|axis| {
            let value = |dot: &PlotPoint| if axis == 0 { dot.x } else { dot.y };
            with_room(dots.iter().flatten().map(value))
        });
        let title = format!("{} ({})", other.name(), unit(other.dimension(), units));
        let x_axis = AxisHints::new_x()
            .label(RichText::new(title).small())
            .tick_label_font(FontId::proportional(11.0))
            .label_spacing(LABELS);
        let name = self.plots.name_of(channel);
        let builder = egui::UiBuilder::new().id_salt(&name).max_rect(strip.plot);
        let ui = &mut ui.new_child(builder);
        let window_s = self.times.window_s.map(f64::to_bits);
        let plot = Plot::new(("channels", self.open.id, &name, window_s))
            .width(strip.plot.width())
            .height(strip.plot.height())
            .custom_x_axes(vec![x_axis])
            .custom_y_axes(vec![strip.value_axis(channel.name(), unit(channel.dimension(), units))])
            .x_grid_spacer(round_marks)
            .y_grid_spacer(close_marks)
            .label_formatter(move |position| match position {
                HoverPosition::NearDataPoint { plot_name, position, .. } => {
                    let [x, y] = [
                        with_unit(other.dimension(), units, position.x / factors[0]),
                        with_unit(channel.dimension(), units, position.y / factors[1]),
                    ];
                    Some(format!("{plot_name}\n{}: {x}\n{}: {y}", other.name(), channel.name()))
                }
                HoverPosition::Elsewhere { .. } => None,
            });
        // Plots of positions have equal scales on both axes, and show all positions.
        let plot = if is_place(channel) && is_place(other) {
            plot.data_aspect(1.0)
        } else {
            plot.default_x_bounds(x[0], x[1]).default_y_bounds(y[0], y[1])
        };
        let shown = plot.show(ui, |plot_ui| {
            for (one, dots) in self.all.iter().zip(dots) {
                plot_ui.add(Marks::dots(&one.name, dots, theme::rgb(colour(one))));
            }
        });
        let role = egui::accesskit::Role::Canvas;
        shown.response.widget_info(|| egui::WidgetInfo::labeled(role, ui.is_enabled(), &name));
        // Marks the values at the time cursor.
        let painter = ui.painter().with_clip_rect(*shown.transform.frame());
        for one in &self.all {
            let at = self.times.cursor_s.and_then(|cursor_s| {
                let x = factors[0] * one.against?.at(cursor_s)?;
                Some(PlotPoint::new(x, factors[1] * one.series.at(cursor_s)?))
            });
            if let Some(at) = at {
                let stroke = Stroke::new(1.8, theme::rgb(theme::cursor(ui.visuals().dark_mode)));
                painter.circle_stroke(shown.transform.position_from_point(&at), 5.0, stroke);
            }
        }
    }

    /// Shows the value at the cursor, with σ if it has one, and for readings and triplets the number of values.
    fn words(&self, ui: &mut egui::Ui, strip: &Strip) {
        let (channel, dark) = (self.channel, ui.visuals().dark_mode);
        let mut lines = Vec::new();
        for one in &self.all {
            let colour = theme::readable(colour(one), dark);
            let text = if one.series.has_sigma() {
                lines.push(RichText::new(channel.name()).strong());
                self.vehicle_at_cursor()
            } else {
                let count = one.series.count(self.times.window_s);
                let at = self.times.cursor_s.and_then(|cursor_s| one.series.at(cursor_s));
                let at = at.map(|value| with_unit(channel.dimension(), self.units, value));
                let at = at.unwrap_or_else(|| "no value".to_owned());
                format!("{}: {count} values; at the cursor {at}", one.name)
            };
            let text = RichText::new(text);
            lines.push(if one.series.has_sigma() { text } else { text.color(colour) });
        }
        strip.words(ui, &lines, channel.describe().hint);
    }

    fn vehicle_at_cursor(&self) -> String {
        let at = || {
            let instant = self.open.way.newest.as_deref()?.at(self.open.timeline.cursor_s?)?;
            self.channel.of_vehicle(&instant)
        };
        let dimension = self.channel.dimension();
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

/// The dots or the lines of a series, in the stored unit.
enum SeriesMarks {
    Dots(Vec<PlotPoint>),
    Lines(Vec<Vec<Corner>>),
}

impl SeriesMarks {
    /// Returns values whose least and greatest are the bounds.
    fn extents(&self) -> Vec<f64> {
        match self {
            Self::Dots(dots) => dots.iter().map(|dot| dot.y).collect(),
            Self::Lines(lines) => {
                lines.iter().flatten().flat_map(|corner| [corner.low, corner.high]).collect()
            }
        }
    }

    fn add<'a>(self, plot_ui: &mut PlotUi<'a>, name: &'a str, colour: Color32, factor: f64) {
        match self {
            Self::Dots(dots) => {
                let dots = dots.into_iter().map(|dot| PlotPoint::new(dot.x, factor * dot.y));
                plot_ui.add(Marks::dots(name, dots.collect(), colour));
            }
            Self::Lines(lines) => {
                let scaled = |corner: Corner| Corner {
                    since_s: corner.since_s,
                    value: factor * corner.value,
                    low: factor * corner.low,
                    high: factor * corner.high,
                };
                let lines = lines.into_iter().map(|line| line.into_iter().map(scaled).collect());
                plot_ui.add(Bands::new(name, lines.collect(), colour));
            }
        }
    }
}

fn colour(seen: &SeenSeries<'_>) -> Rgb {
    match seen.subject {
        (Subject::Station, station) => palette::STATIONS[station],
        (Subject::Pair, pair) => palette::PAIRS[pair],
        (Subject::Prism1, _) => palette::STATIONS[0],
        (Subject::Vehicle, _) => palette::METRICS[0],
    }
}

fn is_place(channel: Channel) -> bool {
    matches!(channel, Channel::X | Channel::Y | Channel::Height)
}
