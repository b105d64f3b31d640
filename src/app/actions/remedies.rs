//! What findings advise, as commands with names.

use super::{Action, Menu};
use crate::app::model::{
    Command, DeploymentCommand, Pane, SceneCommand, TimeCommand, WorkspaceCommand,
};
use crate::app::state::{State, put_right};
use resect_core::analysis::Settings;
use resect_core::calibration::{Alignment, Method, PriorMethod};
use resect_core::deployment::{AS_NUMBERED, Finding, Overrides, Remedy};
use resect_io::override_changes::extras_changes;
use resect_io::source::Extras;

/// A remedy as the window offers it.
pub struct Offer {
    pub name: String,
    /// What does it, or why nothing can.
    pub command: Result<Command, String>,
}

/// What a remedy comes to in this state.
pub fn offer(remedy: &Remedy, state: &State) -> Offer {
    let (name, command) = match remedy {
        Remedy::JointEstimate => ("Use the joint estimate", method(state, Method::Joint)),
        Remedy::PublishedMethod => {
            let published = state.analysed().map(|(_, analysis)| analysis.offer.published_method());
            let chosen = published.unwrap_or(Method::InterPrism);
            let name = format!("Show the paper's {}", chosen.short_name());
            return Offer { name, command: method(state, chosen) };
        }
        Remedy::ClosedFormPrior => (
            "Start from the closed form",
            set(state, |settings| settings.calibration.prior = PriorMethod::ClosedForm),
        ),
        Remedy::LevelAlignment => (
            "Turn about the vertical only",
            set(state, |settings| settings.calibration.alignment = Alignment::Level),
        ),
        Remedy::RelaxFilters => {
            ("Show the filters", Ok(WorkspaceCommand::ShowPane(Pane::Pipeline).into()))
        }
        Remedy::GiveRig => {
            ("Choose a rig file…", of_files(state, DeploymentCommand::ChooseRigDialog))
        }
        Remedy::GiveControlPoints => {
            ("Add control points…", of_files(state, DeploymentCommand::AddControlPointsDialog))
        }
        Remedy::PutRight => {
            ("Show what can be put right", of_files(state, DeploymentCommand::ShowPutRight))
        }
        Remedy::ReadWith(overrides) => return read_with(state, overrides),
        Remedy::ShowTimes(span_s) => {
            ("Show these times", Ok(TimeCommand::LookAtTimes(*span_s).into()))
        }
        Remedy::ShowPoint { file, marker } => {
            let command = SceneCommand::LookAtPoint { file: file.clone(), marker: *marker };
            return Offer { name: format!("Show point {marker}"), command: Ok(command.into()) };
        }
    };
    Offer { name: name.to_owned(), command }
}

fn set(state: &State, change: impl FnOnce(&mut Settings)) -> Result<Command, String> {
    let mut settings = *state.settings();
    change(&mut settings);
    if settings == *state.settings() {
        return Err("It is so already".to_owned());
    }
    Ok(DeploymentCommand::Set(settings).into())
}

fn method(state: &State, method: Method) -> Result<Command, String> {
    let lack = state.analysed().and_then(|(_, analysis)| analysis.offer.lack(method));
    match lack {
        Some(lack) => Err(format!("It needs {lack}")),
        None => set(state, |settings| {
            settings.calibration.method = (method != Method::default()).then_some(method);
        }),
    }
}

/// What only data from files can be given.
fn of_files(state: &State, command: impl Into<Command>) -> Result<Command, String> {
    state
        .extras()
        .map(|_| command.into())
        .ok_or_else(|| "What is open came from no file".to_owned())
}

/// Reading the active deployment again with this said over its files.
fn read_with(state: &State, overrides: &Overrides) -> Offer {
    let Some((open, extras)) = state.active().zip(state.extras()) else {
        let command = of_files(state, DeploymentCommand::ShowPutRight);
        return Offer { name: "Put right".to_owned(), command };
    };
    let mut changed: Extras = extras.clone();
    let now = put_right::effective(extras, &open.deployment);
    changed.put_right = overrides.clone().over(changed.put_right);
    if let Some(stations) = overrides.stations {
        // The readings that are left out stay the same ones.
        changed.put_right.masked = now.masked;
        changed.put_right.renumber(now.stations.unwrap_or(AS_NUMBERED), stations);
    }
    let changes = extras_changes(extras, &changed, &open.deployment.as_read);
    let words: Vec<String> = changes.iter().map(ToString::to_string).collect();
    if words.is_empty() {
        let command = Err("It is so already".to_owned());
        return Offer { name: "Put right".to_owned(), command };
    }
    Offer {
        name: format!("Put right: {}", words.join(", ")),
        command: Ok(DeploymentCommand::PutRight(changed).into()),
    }
}

/// What the reading of the active deployment and its answer say, or why there is none.
pub fn findings(state: &State) -> Vec<Finding> {
    let Some(open) = state.active() else { return Vec::new() };
    let mut findings = open.deployment.findings.clone();
    match open.analysis.as_ref().map(|analysis| &analysis.answer) {
        Some(Ok(answer)) => findings.extend(answer.calibration.findings.iter().cloned()),
        Some(Err(error)) => findings.push(error.finding()),
        None => {}
    }
    findings
}

/// Everything that is advised now.
pub fn actions(state: &State) -> Vec<Action> {
    let mut actions: Vec<Action> = Vec::new();
    for remedy in findings(state).iter().flat_map(|finding| &finding.remedies) {
        let Offer { name, command } = offer(remedy, state);
        if !actions.iter().any(|action| action.name == name) {
            let possible = command.is_ok();
            let command = command.unwrap_or(WorkspaceCommand::ShowPane(Pane::Findings).into());
            let action = Action::new(Menu::Edit, "Advice", name, command);
            actions.push(action.hint("What a finding advises").possible(possible));
        }
    }
    actions
}
