//! Undo, and the switches of the settings.

use egui::{Key, Modifiers};

use super::{Action, Menu};
use crate::app::model::Command;
use crate::app::model::undo::Step;
use crate::app::state::{State, put_right};
use resect_core::analysis::Settings;
use resect_core::calibration::Method;
use resect_core::pipeline::Interpolation;
use resect_io::source::Extras;

pub fn actions(state: &State) -> Vec<Action> {
    let open = state.active().is_some();
    let undo = of_which(state, state.undo.undo_name(state.units), state.undo.next_undo());
    let redo = of_which(state, state.undo.redo_name(state.units), state.undo.next_redo());
    let mut actions = vec![
        Action::new(Menu::Edit, "", undo, Command::Undo)
            .in_general("Undo")
            .ctrl(Key::Z)
            .possible(state.undo.next_undo().is_some()),
        Action::new(Menu::Edit, "", redo, Command::Redo)
            .in_general("Redo")
            .keys(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z)
            .possible(state.undo.next_redo().is_some()),
    ];
    let answered =
        state.active().is_some_and(|open| open.summary.is_some() && !open.joint_follows());
    actions.push(
        Action::new(Menu::Edit, "Result", "Pin the result", Command::Pin)
            .hint("Later results are seen against it")
            .key(Key::P)
            .possible(answered),
    );
    let calibrated = state.active().filter(|open| open.analysing.is_some());
    let stop = Command::CancelAnalysis(calibrated.map_or(0, |open| open.id));
    actions.push(
        Action::new(Menu::Edit, "Result", "Stop the calibration", stop)
            .hint("Back to the settings of the answer that is shown")
            .possible(calibrated.is_some()),
    );
    for pin in &state.results.pins {
        let settings = state.settings_of_pin(pin.id);
        let name = format!("Use the settings of pinned {}", pin.name);
        actions.push(
            Action::new(Menu::Edit, "Result", name, Command::UsePinned(pin.id))
                .possible(open && settings.is_some_and(|settings| settings != *state.settings())),
        );
    }
    actions.push(
        Action::new(
            Menu::Edit,
            "Result",
            "Apply the calibration to the others",
            Command::ValidateOthers,
        )
        .hint("Whether it holds for the other deployments that are open")
        .possible(state.can_validate()),
    );
    actions.extend(data(state));
    let now = state.settings();
    let setting = |section, name: &str, on: bool, change: &dyn Fn(&mut Settings)| {
        let mut settings = *now;
        change(&mut settings);
        Action::new(Menu::Edit, section, name, Command::Set(settings)).on(on).possible(open)
    };
    let pipeline = &now.pipeline;
    actions.push(setting("Pipeline", "Outlier filter", pipeline.outlier_filter, &|settings| {
        settings.pipeline.outlier_filter ^= true;
    }));
    actions.push(setting("Pipeline", "Interval filter", pipeline.interval_filter, &|settings| {
        settings.pipeline.interval_filter ^= true;
    }));
    for choice in Interpolation::ALL {
        let name = format!("Interpolation: {}", choice.title());
        actions.push(setting("Pipeline", &name, pipeline.interpolation == choice, &|settings| {
            settings.pipeline.interpolation = choice;
        }));
    }
    let offer = state.analysed().map(|(_, analysis)| &analysis.offer);
    let method = now.calibration.method.unwrap_or_default();
    for choice in Method::ALL {
        let name = match choice.letter() {
            Some(letter) => format!("Method {letter}: {}", choice.title()),
            None => format!("Method: {}", choice.title()),
        };
        let offered = offer.is_some_and(|offer| offer.lack(choice).is_none());
        let action = setting("Calibration", &name, method == choice, &|settings| {
            settings.calibration.method = (choice != Method::default()).then_some(choice);
        });
        actions.push(action.possible(offered));
    }
    let defaults = setting("All", "Reset to the defaults", false, &|settings| {
        *settings = Settings::default();
    });
    actions.push(Action { on: None, ..defaults }.possible(open && *now != Settings::default()));
    actions.push(
        Action::new(Menu::Edit, "All", "Give all the active one's settings", Command::SetAll)
            .possible(state.open.iter().any(|open| open.settings != *now)),
    );
    actions
}

/// "Undo τ_r 2 → 1.5 m/s", and where several are open of which; what it acts on is shown.
fn of_which(state: &State, name: String, step: Option<&Step>) -> String {
    match step.map(|step| &step.changes[..]) {
        Some([one]) if state.open.len() > 1 => {
            format!("{name} in {}", state.name_of(one.id).unwrap_or_default())
        }
        Some(several @ [_, _, ..]) => format!("{name} in {} deployments", several.len()),
        _ => name,
    }
}

/// What is put right in the data.
fn data(state: &State) -> Vec<Action> {
    let extras = state.active().zip(state.extras());
    let data = |name: &str, extras: Option<Extras>| {
        let possible = extras.is_some();
        let command = Command::PutRight(extras.unwrap_or_default());
        Action::new(Menu::Edit, "Data", name, command).possible(possible)
    };
    let of_picked = |leave_out: bool| {
        let (open, extras) = extras?;
        let picked = open.timeline.picked?;
        let out = put_right::is_masked(extras, &open.deployment, picked);
        (out != leave_out).then(|| put_right::masked(extras, &open.deployment, [picked], leave_out))
    };
    let again = of_picked(false);
    let name = if again.is_some() { "Use this reading again" } else { "Leave this reading out" };
    let of_selection = extras.and_then(|(open, extras)| {
        let span_s = open.timeline.selection_s?;
        Some(put_right::with_span(extras, open, Some(span_s)))
    });
    let all = extras.and_then(|(open, extras)| {
        let span_s = extras.put_right.span_s.or(open.deployment.as_read.span_s);
        span_s.map(|_| put_right::with_span(extras, open, None))
    });
    let can_write = state.active().and_then(|open| open.source.as_ref()?.path()).is_some()
        && extras.is_some_and(|(_, extras)| !extras.is_empty());
    vec![
        data(name, again.or_else(|| of_picked(true)))
            .hint("The picked one; the pane Deployment lists all that is put right")
            .key(Key::X),
        data("Use only the selected times", of_selection)
            .hint("Readings at other times do not count"),
        data("Use all times", all),
        Action::new(Menu::Edit, "Data", "Write to deployment.toml…", Command::WriteDeploymentToml)
            .hint("What is put right, into the folder")
            .possible(can_write),
    ]
}
