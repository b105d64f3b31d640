//! The result: recommendation and verdict first, then the transforms with their σ, changes against a pinned result, the mirror
//! twin, and the metrics.

mod against_pinned;
mod copy_menu;
mod difference_row;
mod extras;
mod methods;
mod metrics;
mod published;
mod recommendation;
mod reliability;
mod transforms;

use egui::{Label, RichText};

pub use self::difference_row::NOTABLE_SIGMAS;
use super::corrections::distance_fields;
use super::{correlations, finding, heading, scrolled};
use crate::app::model::{
    Commands, DeploymentCommand, OpenDeployment, ResultsCommand, WorkspaceCommand,
};
use crate::app::state::State;
use crate::app::theme;
use crate::app::words;
use resect_core::analysis::{Analysis, Answer, Settings};
use resect_core::calibration::{Calibration, Verdict, recommend};
use resect_core::deployment::{Deployment, Finding, Severity, doubts};
use resect_core::pipeline::SampleFate;
use resect_report::glossary;
use resect_report::summary::ResultSummary;
use resect_report::text;
use resect_tools::palette;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    if let Some((open, analysis)) = state.analysed()
        && let Ok(answer) = &analysis.answer
    {
        let margin = egui::Margin { left: 8, right: 8, top: 8, bottom: 0 };
        egui::Frame::new().inner_margin(margin).show(ui, |ui| {
            ui.set_width(ui.available_width());
            if state.is_stale() {
                ui.multiply_opacity(0.45);
            }
            head(ui, state, (open, analysis, answer), commands);
            ui.separator();
        });
    }
    scrolled(ui, |ui| {
        let Some((open, analysis)) = state.analysed() else {
            ui.weak("No result yet.");
            return;
        };
        if state.is_stale() {
            ui.multiply_opacity(0.45);
        }
        match &analysis.answer {
            Ok(answer) => show(ui, state, (open, analysis, answer), commands),
            Err(error) => {
                ui.heading("No result");
                match not_calibrated(&open.deployment) {
                    Some(why) => {
                        ui.label(why);
                    }
                    None => {
                        finding(ui, state, &error.finding(), commands);
                        missing_rig(ui, state, open, commands);
                    }
                }
            }
        }
    });
}

/// Explains why a deployment needs no calibration, or cannot have one; `None` if it can.
fn not_calibrated(deployment: &Deployment) -> Option<String> {
    const USE: &str = "The Evaluation pane compares other trajectories with it.";
    if deployment.ground_truth.is_some() {
        return Some(format!("A trajectory of another system is the ground truth. {USE}"));
    }
    match deployment.stations_with_readings()[..] {
        [only] => Some(format!(
            "A calibration needs several stations, and only station {} has measurements. Its prism's positions are the ground \
             truth. {USE}",
            only + 1
        )),
        _ => None,
    }
}

/// Lets the user enter missing inter-prism distances.
fn missing_rig(ui: &mut egui::Ui, state: &State, open: &OpenDeployment, commands: &mut Commands) {
    let Some(extras) = state.extras().filter(|_| open.deployment.rig.is_none()) else { return };
    ui.add_space(6.0);
    ui.label("The inter-prism distances are unknown. Enter them, or choose a rig file:");
    let mut changed = extras.clone();
    distance_fields(ui, open, extras.corrections.inter_prism_m.clone(), &mut changed);
    if changed != *extras {
        commands.push(DeploymentCommand::Correct(changed).into());
    }
    if ui.button("Choose a rig file…").clicked() {
        commands.push(DeploymentCommand::ChooseRigDialog.into());
    }
}

fn show(
    ui: &mut egui::Ui,
    state: &State,
    (open, analysis, answer): (&OpenDeployment, &Analysis, &Answer),
    commands: &mut Commands,
) {
    let calibration = &answer.calibration;
    let units = state.workspace.units;
    let rows = analysis.rows(&open.deployment);
    let recommendation = recommend(calibration, &open.deployment);
    let stated = recommendation::stated(&recommendation).filter(|_| !open.joint_follows());
    reasons(ui, state, (&calibration.findings, stated), commands);
    if calibration.station1_from_station.len() > 1 {
        heading(ui, "Transforms into station 1");
        transforms::table(ui, &rows, units);
    }
    if !state.workspace.picturing {
        copies(ui, state, open, (analysis, answer), commands);
    }
    transforms::matrices(ui, calibration);
    extras::ui(ui, &rows, calibration, units);
    if let Some(joint) = calibration.joint() {
        reliability::ui(ui, joint, open.deployment.comparable_control_points(), units);
    }
    published::ui(ui, state, calibration, commands);
    against_pinned::ui(ui, state, open, commands);
    methods::ui(ui, calibration, units);
    if let Some(correlation) = calibration.correlation() {
        correlations::ui(ui, &correlation);
    }
    let points = &open.deployment.control_points;
    metrics::ui(ui, &answer.evaluation, &analysis.offer.followed, points);
}

/// Offers the transforms for other programs, and the result as text and as a pin.
fn copies(
    ui: &mut egui::Ui,
    state: &State,
    open: &OpenDeployment,
    (analysis, answer): (&Analysis, &Answer),
    commands: &mut Commands,
) {
    ui.horizontal(|ui| {
        if let Some(summary) = &open.summary {
            copy_menu::ui(ui, summary, commands);
        }
        if ui.button("Copy as text").clicked() {
            let text = text::calibration(&open.deployment, analysis, answer, ToString::to_string);
            commands.push(WorkspaceCommand::Copy(text).into());
        }
        if let Some(summary) = &open.summary {
            pin(ui, state, (open, summary), commands);
        }
    });
}

/// Pins the result for comparison with later ones, unless it is pinned already.
fn pin(
    ui: &mut egui::Ui,
    state: &State,
    (open, summary): (&OpenDeployment, &ResultSummary),
    commands: &mut Commands,
) {
    let pinned = state.results.pins.iter().find(|pin| *pin.summary == *summary);
    let why = pinned.map_or("Available after the joint estimate".to_owned(), |pin| {
        format!("Pinned as {}", pin.name)
    });
    let button = ui
        .add_enabled(pinned.is_none() && !open.joint_follows(), egui::Button::new("Pin"))
        .on_hover_text("Keep this result and compare later ones with it")
        .on_disabled_hover_text(why);
    if button.clicked() {
        commands.push(ResultsCommand::Pin.into());
    }
}

/// Shows the fixed header of the pane: the recommendation, the verdict, and the goodness of fit.
fn head(
    ui: &mut egui::Ui,
    state: &State,
    (open, analysis, answer): (&OpenDeployment, &Analysis, &Answer),
    commands: &mut Commands,
) {
    let calibration = &answer.calibration;
    if open.joint_follows() {
        ui.weak("the joint estimate follows…");
    } else {
        let recommendation = recommend(calibration, &open.deployment);
        recommendation::ui(ui, state, &recommendation, commands);
    }
    verdict(ui, calibration);
    if let Some(spread) = &answer.evaluation.inter_prism_mm {
        let what = metrics::name(&analysis.offer.followed);
        let text = format!("{what} {:.2} mm (median), IQR {:.2} mm", spread.median, spread.iqr);
        words::explain(ui.label(text), &glossary::INTER_PRISM_METRIC);
    }
    readings(ui, open, analysis, answer);
    // A verdict may have become worse by them.
    let changes = state.workspace.units.changes(&Settings::default(), &open.settings);
    if !changes.is_empty() {
        let text = RichText::new(format!("Settings other than the defaults: {changes}"));
        ui.add(Label::new(text).wrap()).on_hover_text("The Pipeline pane resets them");
    }
}

/// Shows the number of readings that the answer uses; the hover card counts the others by reason.
fn readings(ui: &mut egui::Ui, open: &OpenDeployment, analysis: &Analysis, answer: &Answer) {
    let out = &analysis.pipeline;
    let all: usize = open.deployment.tracks.iter().map(|track| track.measurements.len()).sum();
    let kept: usize = out.counts(SampleFate::Kept).iter().sum();
    let joint = answer.calibration.joint();
    let used = joint.map_or(kept, |joint| joint.solution.readings().iter().sum());
    if all > 0 {
        let label = ui.weak(format!("{used} of {all} readings used"));
        let by = if joint.is_some() { "Not used by methods A to D" } else { "Not used" };
        if let Some(unused) = text::unused_readings(out) {
            label.on_hover_text(format!("{by}: {unused}"));
        }
    }
}

/// Shows the doubts and the first notes, without the one that is stated above. Other notes are folded, so that the numbers stay
/// visible.
fn reasons(
    ui: &mut egui::Ui,
    state: &State,
    (findings, stated): (&[Finding], Option<&Finding>),
    commands: &mut Commands,
) {
    const NOTES_IN_SIGHT: usize = 4;
    let mut finding = |ui: &mut egui::Ui, one: &Finding| finding(ui, state, one, commands);
    let others = doubts(findings).into_iter().filter(|one| Some(*one) != stated);
    others.for_each(|one| finding(ui, one));
    let notes: Vec<&Finding> = findings
        .iter()
        .filter(|one| one.severity == Severity::Note && !one.kind.is_tabled())
        .collect();
    let (shown, folded) = notes.split_at(notes.len().min(NOTES_IN_SIGHT));
    shown.iter().for_each(|one| finding(ui, one));
    if !folded.is_empty() {
        ui.collapsing(format!("More notes ({})", folded.len()), |ui| {
            folded.iter().for_each(|one| finding(ui, one));
        });
    }
}

const UNCHECKED: &str = "Nothing that it does not rest on confirms it. Control points that every station measured would, or, for \
                         control points, a drive with known inter-prism distances";

fn verdict(ui: &mut egui::Ui, calibration: &Calibration) {
    ui.horizontal(|ui| {
        let badge = badge(ui, calibration.verdict, 15.0);
        words::explain(badge, &glossary::VERDICT);
        let method = calibration.answered_by();
        words::explain(ui.label(method.label()), words::of_method(method));
    });
    let caveat = calibration.verdict.caveat(calibration.is_independently_checked());
    if !caveat.is_empty() {
        let label = ui.label(caveat.trim_start_matches(", ")).on_hover_text(UNCHECKED);
        words::mark(&label, &[&glossary::UNCHECKED]);
    }
}

/// Shows a verdict on its colour.
pub fn badge(ui: &mut egui::Ui, verdict: Verdict, size: f32) -> egui::Response {
    let [fill, ink] = palette::verdict(verdict).map(theme::rgb);
    let margin = egui::Margin::symmetric((0.65 * size) as i8, (0.25 * size) as i8);
    egui::Frame::new()
        .fill(fill)
        .corner_radius(4.0)
        .inner_margin(margin)
        .show(ui, |ui| {
            let word = verdict.name().to_uppercase();
            ui.label(RichText::new(word).color(ink).strong().size(size))
        })
        .inner
}
