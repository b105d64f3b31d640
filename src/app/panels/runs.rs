//! Results of the session: the pinned ones, and every run with its changes.

use egui::{RichText, WidgetInfo};

use super::result::badge;
use super::{heading, scrolled, use_pinned};
use crate::app::model::ago::ago;
use crate::app::model::{Commands, Pin, ResultsCommand, Run};
use crate::app::short;
use crate::app::state::State;
use resect_core::analysis::Settings;
use resect_report::summary::ResultSummary;

/// Letter size of the verdicts in a list (points).
const BADGE: f32 = 10.0;
/// Indentation of a result's details (points).
const INDENT: f32 = 20.0;
/// Width of the time and the button beside a run (points).
const RIGHT_OF_A_RUN: f32 = 84.0;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    scrolled(ui, |ui| {
        heading(ui, "Pinned results");
        if state.results.pins.is_empty() {
            ui.weak("None. Pin a result to compare later ones with it.");
        }
        for pin in &state.results.pins {
            pinned(ui, state, pin, commands);
        }
        ui.add_space(4.0);
        heading(ui, "Runs of this session");
        if state.results.runs.is_empty() {
            ui.weak("None yet. Each change of a setting adds one.");
        }
        let current = current(state);
        let several = state.results.runs.windows(2).any(|w| w[0].deployment != w[1].deployment);
        for (index, run) in state.results.runs.iter().enumerate().rev() {
            let shown = ShownRun { current: current == Some(run.id), several };
            one(ui, state, (index, run), shown, commands);
        }
        if !state.results.runs.is_empty() {
            ui.small(
                "Click a run to restore its settings. Beside the verdict: median / IQR of the inter-prism metric, and \
                 the median of the worst control points (mm).",
            );
        }
    });
}

/// Presentation of a run.
#[derive(Clone, Copy)]
struct ShownRun {
    /// True if the run has the present settings.
    current: bool,
    /// True if there are runs of several deployments, so that each shows its own.
    several: bool,
}

/// Returns the newest run with the settings of the active deployment.
fn current(state: &State) -> Option<u64> {
    let active = state.active()?;
    let is_it = |run: &&Run| run.deployment == active.id && run.settings == active.settings;
    state.results.runs.iter().rev().find(is_it).map(|run| run.id)
}

fn pinned(ui: &mut egui::Ui, state: &State, pin: &Pin, commands: &mut Commands) {
    let Pin { id, name, summary, shown, .. } = pin;
    ui.horizontal(|ui| {
        let mut show = *shown;
        let of = state.name_of_result(summary);
        let font = egui::TextStyle::Body.resolve(ui.style());
        let room = ui.available_width() - RIGHT_OF_A_RUN - INDENT;
        let shown = short::in_the_middle(ui, &format!("{name}  {of}"), &font, room);
        let switch = ui
            .add(egui::Checkbox::new(&mut show, RichText::new(shown).strong()))
            .on_hover_text(format!("{of}\nShow its residuals behind the present ones"));
        if switch.changed() {
            commands.push(ResultsCommand::ShowPin(*id, show).into());
        }
        right(ui, |ui| {
            if ui.small_button(format!("Unpin {name}")).clicked() {
                commands.push(ResultsCommand::Unpin(*id).into());
            }
        });
    });
    ui.horizontal(|ui| {
        ui.add_space(INDENT);
        numbers(ui, summary);
    });
    let changed = state.workspace.units.changes(&Settings::default(), &summary.settings);
    let words = if changed.is_empty() { "the default settings".to_owned() } else { changed };
    ui.horizontal(|ui| {
        ui.add_space(INDENT);
        ui.vertical(|ui| {
            ui.add(egui::Label::new(RichText::new(words).small()).wrap());
            use_pinned(ui, state, *id, commands);
        });
    });
}

/// Shows the changes of a run, as a button that restores its settings, and its result below.
fn one(
    ui: &mut egui::Ui,
    state: &State,
    (index, run): (usize, &Run),
    ShownRun { current, several }: ShownRun,
    commands: &mut Commands,
) {
    let changed = match state.run_change(run) {
        None => first_in_words(state, run),
        Some(words) if words.is_empty() => "no setting changed".to_owned(),
        Some(words) => words,
    };
    let number = index + 1;
    let verdict = run
        .result
        .as_ref()
        .map_or_else(|_| "no result".to_owned(), |summary| summary.verdict_in_words());
    ui.horizontal(|ui| {
        // The text takes the width that the rest of the line leaves.
        let width = (ui.available_width() - RIGHT_OF_A_RUN).max(0.0);
        let room = egui::vec2(width, ui.spacing().interact_size.y);
        let left = egui::Layout::left_to_right(egui::Align::Center);
        let button = ui.allocate_ui_with_layout(room, left, |ui| {
            ui.add(egui::Button::selectable(current, format!("{number}  {changed}")).truncate())
        });
        let button = button.inner;
        let name = format!("Run {number}, {verdict}: {changed}");
        button.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, current, &name));
        let button = button.on_hover_text(format!("{changed}\nClick: restore these settings"));
        if button.clicked() && !current {
            commands.push(ResultsCommand::RestoreRun(run.id).into());
        }
        right(ui, |ui| {
            let pin = ui.add_enabled(run.result.is_ok(), egui::Button::new("Pin").small());
            let name = format!("Pin run {number}");
            let enabled = run.result.is_ok();
            pin.widget_info(|| WidgetInfo::labeled(egui::Role::Button, enabled, &name));
            let pin = pin
                .on_hover_text("Compare later results with it")
                .on_disabled_hover_text("There is no result to pin");
            if pin.clicked() {
                commands.push(ResultsCommand::PinRun(run.id).into());
            }
            let time = ago(run.at.elapsed()).unwrap_or_else(|| "now".to_owned());
            ui.label(RichText::new(time).small().weak());
        });
    });
    ui.horizontal(|ui| {
        ui.add_space(INDENT);
        match &run.result {
            Ok(summary) => {
                numbers(ui, summary);
            }
            Err(why) => {
                ui.add(egui::Label::new(RichText::new(why).small()).truncate()).on_hover_text(why);
            }
        }
    });
    if several && let Ok(summary) = &run.result {
        let name = state.name_of(run.deployment);
        let name = name.unwrap_or_else(|| summary.deployment.clone());
        ui.horizontal(|ui| {
            ui.add_space(INDENT);
            let font = egui::TextStyle::Small.resolve(ui.style());
            let shown = short::in_the_middle(ui, &name, &font, ui.available_width());
            let label = ui.add(egui::Label::new(RichText::new(&shown).small()).truncate());
            short::whole_on_hover(label, &shown, &name);
        });
    }
}

fn first_in_words(state: &State, run: &Run) -> String {
    let changed = state.workspace.units.changes(&Settings::default(), &run.settings);
    let name = run.result.as_ref().map_or("opened".to_owned(), |summary| {
        state.name_of(run.deployment).unwrap_or_else(|| summary.deployment.clone())
    });
    if changed.is_empty() { name } else { format!("{name}, {changed}") }
}

/// Shows verdict, method and metrics, short enough for a line.
fn numbers(ui: &mut egui::Ui, summary: &ResultSummary) {
    badge(ui, summary.verdict, BADGE);
    let caveat = summary.verdict.caveat(summary.independently_checked);
    if !caveat.is_empty() {
        ui.small("*").on_hover_text(summary.verdict_in_words());
    }
    let method = summary.answered_by();
    ui.label(method.short_name()).on_hover_text(method.title());
    let spread = |spread: Option<(f64, f64)>| {
        spread.map_or("–".to_owned(), |(median, iqr)| format!("{median:.2} / {iqr:.2}"))
    };
    let inter_prism = spread(summary.inter_prism_mm.map(|s| (s.median, s.iqr)));
    let name = if summary.one_prism { "same prism" } else { "inter-prism" };
    ui.small(format!("{name} {inter_prism}")).on_hover_text("Median / IQR (mm)");
    let worst = summary.worst_control_points();
    let text = worst.map_or("–".to_owned(), |metric| format!("{:.2}", metric.spread.median));
    let why_none = match summary.stations.is_empty() {
        true => "One station: the metrics need two",
        false => "No control points",
    };
    let hint = worst.map_or(why_none.to_owned(), |metric| {
        format!("Median of {} (mm), the worst of {}", metric.file, summary.control_points_mm.len())
    });
    ui.small(format!("points {text}")).on_hover_text(hint);
}

/// Adds widgets at the right end of a line.
fn right(ui: &mut egui::Ui, add: impl FnOnce(&mut egui::Ui)) {
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), add);
}
