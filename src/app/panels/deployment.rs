//! The open deployments, and for the active one its stations with counts and visibility, its files, and its rig.

use super::{corrections, finding, heading, scrolled};
use crate::app::actions::solved_together;
use crate::app::model::{
    Commands, DeploymentCommand, OpenDeployment, SceneCommand, SessionCommand, Visibility,
};
use crate::app::short;
use crate::app::state::State;
use crate::app::theme;
use crate::app::words;
use resect_core::calibration::Calibration;
use resect_core::calibration::inter_prism::observability::Hold;
use resect_core::deployment::{Deployment, Severity};
use resect_core::network::{Number, Pair};
use resect_report::glossary;
use resect_tools::palette;

/// Indentation of a line below a deployment's name (points).
const BELOW_A_NAME: f32 = 18.0;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    scrolled(ui, |ui| {
        missing(ui, state, commands);
        let Some(open) = state.active() else {
            ui.weak("Nothing open.");
            return;
        };
        list(ui, state, commands);
        let deployment = &open.deployment;
        let duration_s = match (deployment.start_s(), deployment.end_s()) {
            (Some(start), Some(end)) => end - start,
            _ => 0.0,
        };
        ui.label(format!("{duration_s:.0} s of measurements"));
        ui.add_space(2.0);
        stations(ui, state, open, commands);
        if deployment.ground_truth.is_none() {
            corrections::ui(ui, state, open, commands);
            rig(ui, deployment);
        }
        if let Some(antennas) = &deployment.gnss {
            let fixes: usize = antennas.iter().map(Vec::len).sum();
            ui.label(format!("3 GNSS antennas, {fixes} fixes"));
        }

        heading(ui, "Files");
        for ingredient in &deployment.ingredients {
            let text = egui::RichText::new(&ingredient.file).small();
            let text = if ingredient.used { text } else { text.weak().strikethrough() };
            ui.add(egui::Label::new(text).truncate()).on_hover_text(ingredient.what);
        }
        if deployment.ingredients.iter().any(|i| !i.used) {
            ui.small("Struck out: not used; hover for the reason.");
        }
        for one in deployment.findings.iter().filter(|f| f.severity > Severity::Note) {
            finding(ui, state, one, commands);
        }
    });
}

/// Lists the open deployments: a click shows one, the cross closes it.
fn list(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    for (open, name) in state.deployments.open.iter().zip(state.names()) {
        let active = state.active().is_some_and(|active| active.id == open.id);
        ui.horizontal(|ui| {
            let close = ui
                .add(egui::Button::new("×").small().frame(false))
                .on_hover_text(format!("Close {name}"));
            close.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Close {name}"))
            });
            if close.clicked() {
                commands.push(DeploymentCommand::Close(open.id).into());
            }
            let font = egui::TextStyle::Button.resolve(ui.style());
            let room = ui.available_width() - 2.0 * ui.spacing().button_padding.x;
            let shown = short::in_the_middle(ui, &name, &font, room);
            let label = egui::Button::selectable(active, egui::RichText::new(&shown).strong());
            let button = ui.add(label.truncate());
            button.widget_info(|| {
                egui::WidgetInfo::selected(egui::Role::Button, true, active, &name)
            });
            if short::whole_on_hover(button, &shown, &name).clicked() && !active {
                commands.push(DeploymentCommand::Activate(open.id).into());
            }
        });
        other_drive(ui, state, (open, &name), commands);
    }
}

/// Offers to solve a deployment together with the active one if both have the same control points.
fn other_drive(
    ui: &mut egui::Ui,
    state: &State,
    (open, name): (&OpenDeployment, &str),
    commands: &mut Commands,
) {
    let Some(active) = state.active() else { return };
    let Some(together) = solved_together(active, open) else { return };
    if !active.deployment.shares_survey_with(&open.deployment) {
        return;
    }
    ui.horizontal(|ui| {
        ui.add_space(BELOW_A_NAME);
        ui.small("same control points");
        let label = format!("Solve together: {name}");
        let button = ui.small_button("Solve together");
        button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &label));
        let hint = "Opens both as drives of one set-up. Each is evidence for the other, with its own clocks.";
        if button.on_hover_text(hint).clicked() {
            commands.push(DeploymentCommand::OpenSource(together).into());
        }
    });
}

/// Lists deployments of the session that could not be opened; they stay in the session until the user removes them.
fn missing(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let missing = state.session.missing.iter().zip(state.session.missing_names());
    for (index, (missing, name)) in missing.enumerate() {
        ui.horizontal(|ui| {
            let out = format!("Remove {name} from the session");
            let button = ui.add(egui::Button::new("×").small().frame(false)).on_hover_text(&out);
            button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &out));
            if button.clicked() {
                commands.push(SessionCommand::ForgetMissing(index).into());
            }
            let (colour, sign) = theme::severity(Severity::Warning, ui.visuals().dark_mode);
            ui.label(egui::RichText::new(sign).color(colour));
            let text = egui::RichText::new(format!("{name}: missing")).weak();
            ui.add(egui::Label::new(text).truncate()).on_hover_text(&missing.why);
        });
    }
    if !state.session.missing.is_empty() && ui.button("Try missing deployments again").clicked() {
        commands.push(SessionCommand::RetryMissing.into());
    }
}

/// Shows the inter-prism distances.
fn rig(ui: &mut egui::Ui, deployment: &Deployment) {
    heading(ui, "Rig");
    match &deployment.rig {
        None => {
            ui.label("Inter-prism distances unknown.");
        }
        Some(rig) => {
            egui::Grid::new("rig").num_columns(2).spacing([10.0, 2.0]).show(ui, |ui| {
                for (pair, distance) in rig.inter_prism_m.iter().enumerate() {
                    let name = ui.label(format!("Prisms {}", Pair::at(pair)));
                    words::explain(name, &glossary::INTER_PRISM_DISTANCES);
                    ui.monospace(format!("{distance:.4} m"));
                    ui.end_row();
                }
            });
        }
    }
}

fn stations(ui: &mut egui::Ui, state: &State, open: &OpenDeployment, commands: &mut Commands) {
    if let Some(truth) = &open.deployment.ground_truth {
        let kind = if truth.has_orientations() { "poses" } else { "positions" };
        ui.label(format!("Ground truth of {} {kind} from another system", truth.poses.len()));
        ui.label(match truth.covariances.is_empty() {
            true => "The file states no σ.",
            false => "The file states the covariance of each.",
        });
        return;
    }
    let dark = ui.visuals().dark_mode;
    let mut visibility = state.scene.visibility;
    let is_named = open.deployment.tracks.iter().any(|track| track.name.is_some());
    egui::Grid::new("stations").num_columns(4).spacing([10.0, 3.0]).show(ui, |ui| {
        for (station, track) in open.deployment.tracks.iter().enumerate() {
            let name = format!("Station {}", station + 1);
            let text =
                egui::RichText::new(name).color(theme::readable(palette::station(station), dark));
            let shown = ui.checkbox(&mut visibility.stations[station], text);
            if let Some(name) = &track.name {
                shown.on_hover_text(name);
            }
            ui.label(format!("{} readings", track.measurements.len()));
            ui.label(format!("to {:.0} m", open.longest_range_m[station]));
            if is_named {
                ui.weak(track.name.as_deref().unwrap_or_default());
            }
            ui.end_row();
        }
    });
    ui.horizontal_wrapped(|ui| {
        ui.label("Show");
        ui.checkbox(&mut visibility.raw, "raw");
        ui.checkbox(&mut visibility.tracks, "tracks");
        let points = egui::Checkbox::new(&mut visibility.control_points, "control points");
        ui.add_enabled(!open.deployment.control_points.is_empty(), points);
        ui.checkbox(&mut visibility.poses, "vehicle")
            .on_hover_text("The vehicle's frame along its track: x red, y green, z blue");
        let stated = open.analysis.as_ref().is_some_and(|a| a.pipeline.triplets.sigma_m.is_some());
        ui.add_enabled(stated, egui::Checkbox::new(&mut visibility.uncertainty, "uncertainty"))
            .on_hover_text("σ of the interpolation")
            .on_disabled_hover_text("Straight lines have no σ: choose a Gaussian process");
    });
    what_is_known(ui, open, &mut visibility);
    if visibility != state.scene.visibility {
        commands.push(SceneCommand::Show(visibility).into());
    }
}

/// Shows switches for the uncertainty of the stations.
fn what_is_known(ui: &mut egui::Ui, open: &OpenDeployment, visibility: &mut Visibility) {
    let answer = open.analysis.as_ref().and_then(|analysis| analysis.answer.as_deref().ok());
    let calibration = answer.map(|answer| &answer.calibration);
    let stated = calibration.is_some_and(|calibration| calibration.covariance.is_some());
    let weak = calibration.and_then(Calibration::inter_prism).is_some_and(|details| {
        let observed = &details.observability;
        observed.count(Hold::Held) < observed.directions.len()
    });
    ui.horizontal(|ui| {
        ui.label("Stations");
        let ellipsoids = egui::Checkbox::new(&mut visibility.station_ellipsoids, "σ");
        let ellipsoids = ui.add_enabled(stated, ellipsoids);
        words::mark(&ellipsoids, &[&glossary::ELLIPSOID, &glossary::SIGMA]);
        ellipsoids
            .on_hover_text("95 % confidence ellipsoids of the other stations")
            .on_disabled_hover_text("No σ: a direction is unobservable");
        let arrows = egui::Checkbox::new(&mut visibility.weak_directions, "weak directions");
        let arrows = ui.add_enabled(weak, arrows);
        words::mark(&arrows, &[&glossary::WEAK_DIRECTION]);
        arrows
            .on_hover_text("Motions of the stations that the distances hardly constrain")
            .on_disabled_hover_text("Every direction is observable");
    });
}
