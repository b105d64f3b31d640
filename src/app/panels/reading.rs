//! A raw reading, picked in the scene or in a plot: numbers, fate, and reason.

use egui::RichText;
use resect_core::network::{Number, Pair};

use super::{heading, number_cell, scrolled};
use crate::app::model::units::without_negative_zero;
use crate::app::model::{Commands, DeploymentCommand, OpenDeployment, Picked, TimeCommand, Units};
use crate::app::state::{State, corrections};
use crate::app::theme;
use crate::app::words;
use resect_core::analysis::{Analysis, Settings};
use resect_core::deployment::Severity;
use resect_core::pipeline::SampleFate;
use resect_core::pipeline::explanation::{Explanation, Rate, Step, explain};
use resect_report::glossary;
use resect_tools::palette;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    scrolled(ui, |ui| {
        let Some((open, analysis)) = state.analysed() else {
            ui.weak("Nothing open.");
            return;
        };
        if state.is_stale() {
            ui.multiply_opacity(0.45);
        }
        let explained = open.timeline.picked.and_then(|picked| {
            let settings = &analysis.settings.pipeline;
            explain(&open.deployment, &analysis.pipeline, settings, picked.station, picked.index)
        });
        match explained {
            Some(explained) => show(ui, state, (open, analysis), &explained, commands),
            None => how_to_pick(ui, analysis, commands),
        }
    });
}

fn how_to_pick(ui: &mut egui::Ui, analysis: &Analysis, commands: &mut Commands) {
    ui.label(
        "Click a reading in the scene, or a point in a plot of rates, to see if it is used and why.",
    );
    let first = analysis.pipeline.fates.iter().enumerate().find_map(|(station, fates)| {
        let index = fates.each.iter().position(is_rejected)?;
        Some(Picked { station, index })
    });
    let button = egui::Button::new("First rejected reading");
    let button = ui.add_enabled(first.is_some(), button);
    if let Some(first) = first
        && button.on_disabled_hover_text("No reading was rejected").clicked()
    {
        commands.push(TimeCommand::PickInPlot(first).into());
    }
}

fn show(
    ui: &mut egui::Ui,
    state: &State,
    (open, analysis): (&OpenDeployment, &Analysis),
    explained: &Explanation,
    commands: &mut Commands,
) {
    let dark = ui.visuals().dark_mode;
    let Explanation { station, index, fate, .. } = *explained;
    let count = open.deployment.tracks[station].measurements.len();
    ui.horizontal_wrapped(|ui| {
        let colour = theme::readable(palette::station(station), dark);
        ui.label(RichText::new(format!("Station {}", station + 1)).strong().color(colour));
        ui.label(format!("reading {} of {count}", index + 1));
    });
    ui.horizontal(|ui| {
        let (dot, _) = ui.allocate_exact_size(egui::vec2(12.0, 16.0), egui::Sense::hover());
        ui.painter().circle_filled(dot.center(), 5.0, theme::rgb(palette::fate(fate)));
        words::explain(ui.strong(fate.label()), &glossary::FATE);
    });
    ui.add(
        egui::Label::new(told_in(explained, state.workspace.units).in_words(open.start_s())).wrap(),
    );
    remedy(ui, state, explained, commands);
    leave_out(ui, state, open, Picked { station, index }, commands);
    neighbours(ui, analysis, Picked { station, index }, commands);
    heading(ui, "As measured");
    numbers(ui, explained, open.start_s(), state.workspace.units);
    heading(ui, "Change from the reading before");
    match &explained.step {
        Some(step) => rates(ui, step, state.workspace.units),
        None => {
            ui.weak("First reading of its station: no change to show.");
        }
    }
    if fate == SampleFate::Kept {
        heading(ui, "Distance errors here");
        distance_errors(ui, analysis, explained.reading.time_s);
    }
}

/// The explanation with its rates in the user's unit.
fn told_in(explained: &Explanation, units: Units) -> Explanation {
    let mut told = explained.clone();
    if let Some(step) = &mut told.step {
        step.rates = step.rates.map(|rate| rate_in(rate, units));
    }
    told
}

fn rate_in(rate: Rate, units: Units) -> Rate {
    rate.told_in(units.angle.rate_name(), units.angle.rate_per_deg_per_s())
}

/// Offers the least change of a threshold that makes the rejecting module accept the reading.
fn remedy(ui: &mut egui::Ui, state: &State, explained: &Explanation, commands: &mut Commands) {
    let Some(pipeline) = explained.remedy() else { return };
    let settings = Settings { pipeline, ..*state.settings() };
    let changes = state.workspace.units.changes(state.settings(), &settings);
    let button = ui.button(format!("Set {changes}")).on_hover_text(
        "The module that rejected this reading would accept it. The thresholds apply to all readings, not only to this \
         one alone.",
    );
    if button.clicked() {
        commands.push(DeploymentCommand::Set(settings).into());
    }
}

/// Adds a button that excludes the reading, or includes it again.
fn leave_out(
    ui: &mut egui::Ui,
    state: &State,
    open: &OpenDeployment,
    picked: Picked,
    commands: &mut Commands,
) {
    let Some(extras) = state.extras() else { return };
    let out = corrections::is_masked(extras, &open.deployment, picked);
    let name = if out { "Use it again" } else { "Leave this reading out" };
    let button = ui.button(name).on_hover_text("Masks it by its time stamp (X); Undo reverts it");
    if button.clicked() {
        let extras = corrections::masked(extras, &open.deployment, [picked], !out);
        commands.push(DeploymentCommand::Correct(extras).into());
    }
}

/// Adds buttons that select other readings of the station.
fn neighbours(ui: &mut egui::Ui, analysis: &Analysis, at: Picked, commands: &mut Commands) {
    let (before, from_here) = analysis.pipeline.fates[at.station].each.split_at(at.index);
    let after = &from_here[1..];
    let next = at.index + 1;
    let rejected_before = before.iter().rposition(is_rejected);
    let rejected_after = after.iter().position(is_rejected).map(|further| next + further);
    let mut go = |ui: &mut egui::Ui, name: &str, index: Option<usize>| {
        let button = ui.add_enabled(index.is_some(), egui::Button::new(name));
        if let Some(index) = index
            && button.clicked()
        {
            commands.push(TimeCommand::PickInPlot(Picked { index, ..at }).into());
        }
    };
    egui::Grid::new("other readings").num_columns(2).spacing([6.0, 4.0]).show(ui, |ui| {
        go(ui, "Previous reading", at.index.checked_sub(1));
        go(ui, "Next reading", (!after.is_empty()).then_some(next));
        ui.end_row();
        go(ui, "Previous rejected", rejected_before);
        go(ui, "Next rejected", rejected_after);
        ui.end_row();
    });
}

fn is_rejected(fate: &SampleFate) -> bool {
    matches!(fate, SampleFate::Rejected(_))
}

fn numbers(ui: &mut egui::Ui, explained: &Explanation, start_s: f64, units: Units) {
    let reading = &explained.reading;
    let [length, angle] = [units.length.name(), units.angle.name()];
    let gap = |gap_s: Option<f64>| gap_s.map_or("–".to_owned(), |gap_s| format!("{gap_s:.2}"));
    egui::Grid::new("as measured").num_columns(2).spacing([10.0, 2.0]).striped(true).show(
        ui,
        |ui| {
            for (name, value) in [
                ("time (s)".to_owned(), format!("{:.2}", reading.time_s - start_s)),
                (format!("range ({length})"), units.length(reading.range_m)),
                (format!("azimuth ({angle})"), units.angle(reading.azimuth_rad)),
                (format!("zenith angle ({angle})"), units.angle(reading.zenith_rad)),
                ("gap before (s)".to_owned(), gap(explained.gap_before_s)),
                ("gap after (s)".to_owned(), gap(explained.gap_after_s)),
            ] {
                words::explain_text(ui.label(&name), &name);
                number_cell(ui, value, 11);
                ui.end_row();
            }
        },
    );
}

/// Shows each rate beside its threshold, with a sign if it exceeds it.
fn rates(ui: &mut egui::Ui, step: &Step, units: Units) {
    let (colour, _) = theme::severity(Severity::Problem, ui.visuals().dark_mode);
    egui::Grid::new("rates").num_columns(3).spacing([10.0, 2.0]).striped(true).show(ui, |ui| {
        for name in ["rate of", "", "allowed"] {
            ui.label(name);
        }
        ui.end_row();
        for rate in step.rates.map(|rate| rate_in(rate, units)) {
            ui.label(format!("{} ({})", rate.name(), rate.unit));
            let value = without_negative_zero(rate.value, 2);
            let text = RichText::new(value);
            number_cell(ui, if rate.exceeds() { text.strong().color(colour) } else { text }, 8);
            let allowed = rate.threshold.map_or("filter off".to_owned(), |threshold| {
                let sign = if rate.exceeds() { "  ✗" } else { "" };
                let threshold = (threshold * 1e4).round() / 1e4;
                format!("{} {threshold}{sign}", rate.threshold_name())
            });
            words::explain_text(ui.label(&allowed), &allowed);
            ui.end_row();
        }
    });
}

/// Shows the distance errors of the triplet nearest in time (mm).
fn distance_errors(ui: &mut egui::Ui, analysis: &Analysis, time_s: f64) {
    let answer = analysis.answer.as_ref().ok();
    let errors_mm = answer.zip(analysis.triplets().nearest(time_s)).and_then(|(answer, index)| {
        let errors_mm = answer.evaluation.distance_errors_mm.iter();
        errors_mm.map(|own| own.get(index).copied()).collect::<Option<Vec<f64>>>()
    });
    let Some(errors_mm) = errors_mm.filter(|errors_mm| !errors_mm.is_empty()) else {
        ui.weak("No triplet near it, or no result.");
        return;
    };
    let dark = ui.visuals().dark_mode;
    egui::Grid::new("errors").num_columns(2).spacing([10.0, 2.0]).show(ui, |ui| {
        for (pair, error_mm) in errors_mm.into_iter().enumerate() {
            let colour = theme::readable(palette::pair(pair), dark);
            ui.label(RichText::new(format!("prisms {} (mm)", Pair::at(pair))).color(colour));
            number_cell(ui, format!("{error_mm:+.2}"), 8);
            ui.end_row();
        }
    });
}
