//! Remedies of findings as named commands.

use super::{Action, Menu};
use crate::app::model::{
    Command, DeploymentCommand, Pane, SceneCommand, TimeCommand, WorkspaceCommand,
};
use crate::app::state::{State, corrections};
use resect_core::analysis::Settings;
use resect_core::calibration::{Alignment, Method, PriorMethod};
use resect_core::deployment::{Finding, Overrides, Remedy, as_numbered};
use resect_io::override_changes::extras_changes;
use resect_io::source::Extras;

/// A remedy as the window offers it.
pub struct Offer {
    pub name: String,
    /// The command, or the reason why it is not available.
    pub command: Result<Command, String>,
}

/// Returns the offer for a remedy in this state.
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
            "Use the closed-form prior",
            set(state, |settings| settings.calibration.prior = PriorMethod::ClosedForm),
        ),
        Remedy::LevelAlignment => (
            "Rotate about the vertical only",
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
        Remedy::Corrections => {
            ("Show the corrections", of_files(state, DeploymentCommand::ShowCorrections))
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
        return Err("Already set".to_owned());
    }
    Ok(DeploymentCommand::Set(settings).into())
}

fn method(state: &State, method: Method) -> Result<Command, String> {
    let lack = state.analysed().and_then(|(_, analysis)| analysis.offer.lack(method));
    match lack {
        Some(lack) => Err(format!("Needs {lack}")),
        None => set(state, |settings| {
            settings.calibration.method = (method != Method::default()).then_some(method);
        }),
    }
}

/// Returns the command if the data is from files, otherwise an error.
fn of_files(state: &State, command: impl Into<Command>) -> Result<Command, String> {
    state
        .extras()
        .map(|_| command.into())
        .ok_or_else(|| "Not available: the data is not from a file".to_owned())
}

/// Offers to read the active deployment again with these overrides over its files.
fn read_with(state: &State, overrides: &Overrides) -> Offer {
    let Some((open, extras)) = state.active().zip(state.extras()) else {
        let command = of_files(state, DeploymentCommand::ShowCorrections);
        return Offer { name: "Correct".to_owned(), command };
    };
    let mut changed: Extras = extras.clone();
    let now = corrections::effective(extras, &open.deployment);
    changed.corrections = overrides.clone().over(changed.corrections);
    if let Some(stations) = overrides.stations.clone() {
        // Masks still exclude the same readings.
        changed.corrections.masked = now.masked;
        let usual = || as_numbered(open.deployment.tracks.len());
        changed.corrections.renumber(&now.stations.unwrap_or_else(usual), stations);
    }
    let changes = extras_changes(extras, &changed, &open.deployment.as_read);
    let words: Vec<String> = changes.iter().map(ToString::to_string).collect();
    if words.is_empty() {
        let command = Err("Already set".to_owned());
        return Offer { name: "Correct".to_owned(), command };
    }
    Offer {
        name: format!("Correct: {}", words.join(", ")),
        command: Ok(DeploymentCommand::Correct(changed).into()),
    }
}

/// Returns the findings of the active deployment's readers and result, or the reason why there is no result.
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

/// Returns all actions that are advised now.
pub fn actions(state: &State) -> Vec<Action> {
    let mut actions: Vec<Action> = Vec::new();
    for remedy in findings(state).iter().flat_map(|finding| &finding.remedies) {
        let Offer { name, command } = offer(remedy, state);
        if !actions.iter().any(|action| action.name == name) {
            let possible = command.is_ok();
            let command = command.unwrap_or(WorkspaceCommand::ShowPane(Pane::Findings).into());
            let action = Action::new(Menu::Edit, "Advice", name, command);
            actions.push(action.hint("Advised by a finding").possible(possible));
        }
    }
    actions
}
