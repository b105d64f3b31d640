//! Channels over time or against another channel, with errors of other systems' trajectories above them.

mod choice;
mod shared_plot;
mod value_scale;

use egui::RichText;

use self::choice::{BUTTON, choice, plot_button};
use self::shared_plot::ChannelPlot;
use super::strips::{Strip, strips};
use super::time_plot;
use super::times::Times;
use super::{estimate_errors, in_the_middle, pair_switches, station_switches};
use crate::app::model::channel_plots::SharedPlot;
use crate::app::model::{ChannelPlots, Commands, OpenDeployment, TimeCommand};
use crate::app::prepared::channels::{Channel, Subject};
use crate::app::state::State;
use crate::app::theme;
use resect_core::pipeline::SampleFate;
use resect_tools::estimates::Judged;
use resect_tools::palette;

/// Narrower panes show the choice of channels and the switches of their series on separate lines (points).
const NARROW: f32 = 640.0;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let Some((open, _)) = state.analysed() else {
        in_the_middle(ui, "Nothing open.");
        return;
    };
    if state.is_stale() {
        ui.multiply_opacity(0.45);
    }
    let times = Times::of(open, state);
    let plots = &state.time.plots;
    heads(ui, state, (open, &times), commands);
    let judged: Vec<(usize, &Judged)> =
        if plots.errors { open.judging.judged().collect() } else { Vec::new() };
    if judged.is_empty() && plots.shown.is_empty() {
        in_the_middle(ui, nothing_shown(open, plots));
        return;
    }
    let drawn: Vec<ChannelPlot<'_>> =
        (plots.shown.iter()).map(|shared| ChannelPlot::of(state, open, shared, &times)).collect();
    let lines = drawn.iter().map(|plot| plot.all.len()).max().unwrap_or(0).max(2);
    let places = strips(ui, judged.len() + drawn.len(), lines);
    let (of_errors, of_channels) = places.split_at(judged.len());
    estimate_errors::show(ui, state, (open, &times), of_errors, &judged, commands);
    for (index, (strip, plot)) in of_channels.iter().zip(&drawn).enumerate() {
        if plot.all.is_empty() {
            let name = plot.shared.name();
            strip.words(ui, &[RichText::new(&name).strong()], "");
            let builder = egui::UiBuilder::new().id_salt(&name).max_rect(strip.plot);
            in_the_middle(&mut ui.new_child(builder), nothing(open, plots, plot.shared));
        } else {
            match plots.against {
                None => plot.over_time(ui, strip, commands),
                Some(other) => plot.against(ui, strip, other),
            }
            // The button of the plot is beside its words.
            let words = strip.words.with_max_x(strip.words.right() - BUTTON);
            plot.words(ui, &Strip { words, ..*strip });
        }
        if !state.workspace.picturing {
            plot_button(ui, strip, plots, index, commands);
        }
    }
}

/// Shows the choice of channels and the switches of their series, in one line or two.
fn heads(
    ui: &mut egui::Ui,
    state: &State,
    (open, times): (&OpenDeployment, &Times),
    commands: &mut Commands,
) {
    let plots = &state.time.plots;
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
        if plots.fates && plots.channels().any(Channel::is_of_readings) {
            fates(ui, open);
        }
        time_plot::selection(ui, state, times, commands);
        let is_over_time = plots.against.is_none() && has_channels;
        if is_over_time || (plots.errors && !plots.by_distance) {
            time_plot::hint(ui, state, "");
        }
    });
}

/// Reason why the pane is empty.
fn nothing_shown(open: &OpenDeployment, plots: &ChannelPlots) -> &'static str {
    match open.judging.judgement.is_running() {
        true => "Evaluating…",
        false if plots.errors && !open.judging.added.is_empty() => {
            "No trajectory could be evaluated: see the Evaluation pane."
        }
        false => "No channel selected: choose one under Show…",
    }
}

/// Reason why a plot has no series.
fn nothing<'a>(open: &'a OpenDeployment, plots: &ChannelPlots, shared: &SharedPlot) -> &'a str {
    let against = plots.against.map(|other| other.channel);
    let all: Vec<Channel> = shared.channels().map(|(channel, _)| channel).chain(against).collect();
    let is_one_of = |some: &[Channel]| all.iter().any(|own| some.contains(own));
    let way = open.way.newest.as_deref();
    if all.iter().any(|own| own.subject() == Subject::Vehicle) {
        way.and_then(|way| way.why_not.as_deref()).unwrap_or("Not determined by this result.")
    } else if is_one_of(&[Channel::OwnClock]) {
        "No station clocks in these files."
    } else if is_one_of(&[Channel::X, Channel::Y, Channel::Height]) {
        "The station positions are not determined, or all are hidden."
    } else {
        "The data has no such values, or all are hidden."
    }
}

/// Shows the fates that readings have, in their colours.
fn fates(ui: &mut egui::Ui, open: &OpenDeployment) {
    let Some(analysis) = open.analysis.as_deref() else { return };
    let dark = ui.visuals().dark_mode;
    let occurs = |fate: &SampleFate| {
        (0..analysis.pipeline.fates.len())
            .any(|station| analysis.pipeline.count(station, *fate) > 0)
    };
    for fate in SampleFate::ALL.into_iter().filter(occurs).filter(|it| *it != SampleFate::Kept) {
        let text = format!("× {}", fate.label());
        ui.label(RichText::new(text).small().color(theme::readable(palette::fate(fate), dark)));
    }
}
