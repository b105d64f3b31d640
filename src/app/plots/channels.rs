//! Any channel over time, or against another one.

use egui::{FontId, RichText, Stroke};
use egui_plot::{AxisHints, HoverPosition, Plot, PlotPoint};

use super::dimension_units::{per_stored, unit, with_unit};
use super::marks::Marks;
use super::strips::{Strip, strips};
use super::time_plot::{self, TimePlot};
use super::times::Times;
use super::{
    LABELS, close_marks, in_the_middle, pair_switches, round_marks, station_switches, with_room,
};
use crate::app::model::plotted::{APART, SeenSeries};
use crate::app::model::{Commands, OpenDeployment, Plotted, TimeCommand, Units};
use crate::app::prepared::channels::{Channel, Of};
use crate::app::state::State;
use crate::app::theme;
use resect_core::palette;
use resect_core::palette::Rgb;

/// What stands beside the two boxes of what is plotted (points).
const BESIDE_BOXES: f32 = 90.0;
/// Narrower panes have no room for what is plotted beside what of it is shown (points).
const NARROW: f32 = 640.0;
/// Three times as many dots of a series are all drawn.
const LEAST_RUNS: usize = 800;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let Some((open, _)) = state.analysed() else {
        in_the_middle(ui, "No readings to plot.");
        return;
    };
    let times = Times::of(open, state);
    let plotted = state.time.plotted;
    let is_narrow = ui.available_width() < NARROW;
    if is_narrow {
        time_plot::head(ui, |ui| choice(ui, plotted, commands));
    }
    time_plot::head(ui, |ui| {
        if !is_narrow {
            choice(ui, plotted, commands);
        }
        match plotted.channel.of() {
            Of::Station => station_switches(ui, state, commands),
            Of::Pair => pair_switches(ui, state, commands),
            Of::Vehicle => {}
        }
        let name = "Save as CSV…";
        let button = ui.small_button(name);
        if button.on_hover_text("Every value of what is shown, not only those drawn").clicked() {
            commands.push(TimeCommand::SaveChannelsDialog.into());
        }
        time_plot::selection(ui, &times, commands);
        if plotted.against.is_none() {
            time_plot::hint(ui, "");
        }
    });
    let all = plotted.seen(&open.plots, &state.scene.visibility);
    if all.is_empty() {
        in_the_middle(ui, nothing(plotted));
        return;
    }
    let strip = strips(ui, 1, all.len())[0];
    let pane = ChannelPlot { open, units: state.workspace.units, plotted, times, all };
    match plotted.against {
        None => pane.over_time(ui, &strip, commands),
        Some(other) => pane.against(ui, &strip, other),
    }
    pane.words(ui, &strip);
}

/// Why there is nothing to see.
fn nothing(plotted: Plotted) -> &'static str {
    let is_of = |channels: &[Channel]| {
        channels.contains(&plotted.channel)
            || plotted.against.is_some_and(|other| channels.contains(&other))
    };
    if is_of(&[Channel::OwnClock]) {
        "No file tells the stations' own clocks."
    } else if is_of(&[Channel::X, Channel::Y, Channel::Height]) {
        "Nothing tells where the stations stand, or all are hidden."
    } else {
        "The data has none of these, or all are hidden."
    }
}

/// What is plotted, and against what.
fn choice(ui: &mut egui::Ui, plotted: Plotted, commands: &mut Commands) {
    let mut chosen = plotted;
    let width = (0.5 * (ui.available_width() - BESIDE_BOXES)).clamp(40.0, 130.0);
    let named = |response: egui::Response, name: &str| {
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, name));
    };
    let combo = egui::ComboBox::from_id_salt("channel").selected_text(plotted.channel.name());
    let combo = combo.width(width).truncate().height(400.0).show_ui(ui, |ui| {
        for channel in Channel::ALL {
            let on = channel == plotted.channel;
            if ui.selectable_label(on, channel.name()).on_hover_text(channel.hint()).clicked() {
                chosen = plotted.with_channel(channel);
            }
        }
    });
    named(combo.response, "What is plotted");
    ui.small("against");
    let against = plotted.against.map_or("time", Channel::name);
    let combo = egui::ComboBox::from_id_salt("against").selected_text(against);
    let combo = combo.width(width).truncate().height(400.0).show_ui(ui, |ui| {
        if ui.selectable_label(plotted.against.is_none(), "time").clicked() {
            chosen.against = None;
        }
        for channel in Channel::ALL {
            let possible = plotted.channel.goes_with(channel);
            let on = plotted.against == Some(channel);
            let entry = ui.add_enabled(possible, egui::Button::selectable(on, channel.name()));
            let entry = entry.on_disabled_hover_text(APART);
            if entry.on_hover_text(channel.hint()).clicked() {
                chosen.against = Some(channel);
            }
        }
    });
    named(combo.response, "What it is plotted against");
    if chosen != plotted {
        commands.push(TimeCommand::Plot(chosen).into());
    }
}

struct ChannelPlot<'a> {
    open: &'a OpenDeployment,
    units: Units,
    plotted: Plotted,
    times: Times,
    all: Vec<SeenSeries<'a>>,
}

impl ChannelPlot<'_> {
    fn over_time(&self, ui: &mut egui::Ui, strip: &Strip, commands: &mut Commands) {
        let (channel, units, scale) = (self.plotted.channel, self.units, self.times.scale);
        let factor = per_stored(channel.dimension(), units);
        let runs = (strip.plot.width() as usize).max(LEAST_RUNS);
        let dots: Vec<Vec<PlotPoint>> = (self.all.iter())
            .map(|one| {
                let dots = one.series.over_time(self.times.window_s, runs).into_iter();
                dots.map(|dot| PlotPoint::new(dot.x, factor * dot.y)).collect()
            })
            .collect();
        let y_bounds = with_room(dots.iter().flatten().map(|dot| dot.y));
        let plot = Plot::new(("channels", self.open.id))
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
        let name = self.plotted.in_words();
        let time_plot = TimePlot { strip, name: &name, times: &self.times, y_bounds };
        let shown = time_plot.show(ui, plot, axis, commands, |plot_ui| {
            for (one, dots) in self.all.iter().zip(dots) {
                plot_ui.add(Marks::dots(&one.name, dots, theme::rgb(colour(one))));
            }
        });
        shown.paint_times(ui, &self.times);
        shown.on_click(&self.times, commands, |_| None);
    }

    fn against(&self, ui: &mut egui::Ui, strip: &Strip, other: Channel) {
        let (channel, units) = (self.plotted.channel, self.units);
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
        let name = self.plotted.in_words();
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
        // Of places one metre is as long along both axes, and so that all of them are seen.
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
        // Where the cursor is in time.
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

    /// How many values of each are shown, and what it is at the cursor.
    fn words(&self, ui: &mut egui::Ui, strip: &Strip) {
        let (channel, dark) = (self.plotted.channel, ui.visuals().dark_mode);
        let mut lines = Vec::new();
        for one in &self.all {
            let count = one.series.count(self.times.window_s);
            let at = self.times.cursor_s.and_then(|cursor_s| one.series.at(cursor_s));
            let at = at.map(|value| with_unit(channel.dimension(), self.units, value));
            let at = at.unwrap_or_else(|| "nothing".to_owned());
            let colour = theme::readable(colour(one), dark);
            let text = format!("{}: {count} values; at the cursor {at}", one.name);
            lines.push(RichText::new(text).color(colour));
        }
        strip.words(ui, &lines, channel.hint());
    }
}

fn colour(seen: &SeenSeries<'_>) -> Rgb {
    match seen.of {
        (Of::Station, station) => palette::STATIONS[station],
        (Of::Pair, pair) => palette::PAIRS[pair],
        (Of::Vehicle, _) => palette::STATIONS[0],
    }
}

fn is_place(channel: Channel) -> bool {
    matches!(channel, Channel::X | Channel::Y | Channel::Height)
}
