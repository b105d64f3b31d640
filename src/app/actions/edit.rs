//! Actions of the menu Edit: undo, settings, results and corrections.

use egui::{Key, Modifiers};

use super::{Action, Menu};
use crate::app::model::undo::UndoStep;
use crate::app::model::{DeploymentCommand, ResultsCommand};
use crate::app::state::{State, corrections};
use resect_core::analysis::Settings;
use resect_core::calibration::Method;
use resect_core::pipeline::Interpolation;
use resect_io::source::Extras;

pub fn actions(state: &State) -> Vec<Action> {
    let mut actions = Vec::from(steps(state));
    actions.extend(results(state));
    actions.extend(data(state));
    actions.extend(pipeline(state));
    actions.extend(methods(state));
    actions.extend(of_all_settings(state));
    actions
}

/// Undo and redo.
fn steps(state: &State) -> [Action; 2] {
    let (undo, units) = (&state.deployments.undo, state.workspace.units);
    let (undone, redone) = (undo.next_undo(), undo.next_redo());
    let undo_name = of_which(state, undo.undo_name(units), undone);
    let redo_name = of_which(state, undo.redo_name(units), redone);
    [
        Action::new(Menu::Edit, "", undo_name, DeploymentCommand::Undo)
            .in_general("Undo")
            .ctrl(Key::Z)
            .possible(undone.is_some()),
        Action::new(Menu::Edit, "", redo_name, DeploymentCommand::Redo)
            .in_general("Redo")
            .keys(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z)
            .possible(redone.is_some()),
    ]
}

/// Pins, cancelling of the calibration, and the validation.
fn results(state: &State) -> Vec<Action> {
    let result =
        |name: &str, command: ResultsCommand| Action::new(Menu::Edit, "Result", name, command);
    let answered =
        state.active().is_some_and(|open| open.summary.is_some() && !open.joint_follows());
    let calibrated = state.active().filter(|open| open.analysing.is_some());
    let stop = DeploymentCommand::CancelAnalysis(calibrated.map_or(0, |open| open.id));
    let mut actions = vec![
        result("Pin the result", ResultsCommand::Pin)
            .hint("Later results are compared with it")
            .key(Key::P)
            .possible(answered),
        Action::new(Menu::Edit, "Result", "Stop the calibration", stop)
            .hint("Restores the settings of the shown result")
            .possible(calibrated.is_some()),
    ];
    let open = state.active().is_some();
    actions.extend(state.results.pins.iter().map(|pin| {
        let settings = state.settings_of_pin(pin.id);
        let name = format!("Use the settings of pinned {}", pin.name);
        result(&name, ResultsCommand::UsePinned(pin.id))
            .possible(open && settings.is_some_and(|settings| settings != *state.settings()))
    }));
    actions.push(
        result("Apply the calibration to the others", ResultsCommand::ValidateOthers)
            .hint("Tests the calibration on the other open deployments")
            .possible(state.can_validate()),
    );
    actions
}

/// Returns an action that changes the settings of the active deployment.
fn setting(
    state: &State,
    section: &'static str,
    name: &str,
    on: bool,
    change: impl FnOnce(&mut Settings),
) -> Action {
    let mut settings = *state.settings();
    change(&mut settings);
    Action::new(Menu::Edit, section, name, DeploymentCommand::Set(settings))
        .on(on)
        .possible(state.active().is_some())
}

fn pipeline(state: &State) -> Vec<Action> {
    let now = &state.settings().pipeline;
    let mut actions = vec![
        setting(state, "Pipeline", "Outlier filter", now.outlier_filter, |settings| {
            settings.pipeline.outlier_filter ^= true;
        }),
        setting(state, "Pipeline", "Interval filter", now.interval_filter, |settings| {
            settings.pipeline.interval_filter ^= true;
        }),
        setting(state, "Pipeline", "Joint estimate: all readings", now.all_readings, |settings| {
            settings.pipeline.all_readings ^= true;
        }),
    ];
    actions.extend(Interpolation::ALL.map(|choice| {
        let name = format!("Interpolation: {}", choice.title());
        setting(state, "Pipeline", &name, now.interpolation == choice, |settings| {
            settings.pipeline.interpolation = choice;
        })
    }));
    actions
}

fn methods(state: &State) -> Vec<Action> {
    let offer = state.analysed().map(|(_, analysis)| &analysis.offer);
    let method = state.settings().calibration.method.unwrap_or_default();
    let action = |choice: Method| {
        let name = match choice.letter() {
            Some(letter) => format!("Method {letter}: {}", choice.title()),
            None => format!("Method: {}", choice.title()),
        };
        let offered = offer.is_some_and(|offer| offer.lack(choice).is_none());
        let action = setting(state, "Calibration", &name, method == choice, |settings| {
            settings.calibration.method = (choice != Method::default()).then_some(choice);
        });
        action.possible(offered)
    };
    Method::ALL.into_iter().map(action).collect()
}

/// Resetting to the defaults, and copying the settings to all open deployments.
fn of_all_settings(state: &State) -> [Action; 2] {
    let now = state.settings();
    let defaults = setting(state, "All", "Reset to the defaults", false, |settings| {
        *settings = Settings::default();
    });
    let tuned = state.active().is_some() && *now != Settings::default();
    let name = "Copy these settings to all runs";
    [
        Action { on: None, ..defaults }.possible(tuned),
        Action::new(Menu::Edit, "All", name, DeploymentCommand::SetAll)
            .possible(state.deployments.open.iter().any(|open| open.settings != *now)),
    ]
}

/// Returns "Undo τ_r 2 → 1.5 m/s", with the affected deployment's name if several are open.
fn of_which(state: &State, name: String, step: Option<&UndoStep>) -> String {
    match step.map(|step| &step.changes[..]) {
        Some([one]) if state.deployments.open.len() > 1 => {
            format!("{name} in {}", state.name_of(one.id).unwrap_or_default())
        }
        Some(several @ [_, _, ..]) => format!("{name} in {} deployments", several.len()),
        _ => name,
    }
}

/// Corrections of the data.
fn data(state: &State) -> Vec<Action> {
    let extras = state.active().zip(state.extras());
    let data = |name: &str, extras: Option<Extras>| {
        let possible = extras.is_some();
        let command = DeploymentCommand::Correct(extras.unwrap_or_default());
        Action::new(Menu::Edit, "Data", name, command).possible(possible)
    };
    let of_picked = |leave_out: bool| {
        let (open, extras) = extras?;
        let picked = open.timeline.picked?;
        let out = corrections::is_masked(extras, &open.deployment, picked);
        (out != leave_out)
            .then(|| corrections::masked(extras, &open.deployment, [picked], leave_out))
    };
    let again = of_picked(false);
    let name = if again.is_some() { "Use this reading again" } else { "Leave this reading out" };
    let of_selection = extras.and_then(|(open, extras)| {
        let span_s = open.timeline.selection_s?;
        Some(corrections::with_span(extras, open, Some(span_s)))
    });
    let all = extras.and_then(|(open, extras)| {
        let span_s = extras.corrections.span_s.or(open.deployment.as_read.span_s);
        span_s.map(|_| corrections::with_span(extras, open, None))
    });
    let can_write = state.active().and_then(|open| open.source.as_ref()?.path()).is_some()
        && extras.is_some_and(|(_, extras)| !extras.is_empty());
    vec![
        data(name, again.or_else(|| of_picked(true)))
            .hint("The picked reading; the Deployment pane lists all corrections")
            .key(Key::X),
        data("Use only the selected times", of_selection)
            .hint("Readings at other times do not count"),
        data("Use all times", all),
        Action::new(
            Menu::Edit,
            "Data",
            "Write to deployment.toml…",
            DeploymentCommand::WriteDeploymentToml,
        )
        .hint("Saves the corrections in the deployment's folder")
        .possible(can_write),
    ]
}
