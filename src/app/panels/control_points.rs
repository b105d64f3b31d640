//! The control points: residuals by station, and their use in the calibration.

use egui::{RichText, Role, WidgetInfo};

use super::{number_cell, right_aligned};
use crate::app::model::{Commands, SceneCommand};
use crate::app::prepared::control_points::{PointResidual, residuals};
use crate::app::state::State;
use crate::app::theme;
use resect_tools::palette;

/// Width of a column for a name or a number (points).
const COLUMN: f32 = 50.0;
/// Width of a number (figures).
const FIGURES: usize = 6;

/// Numbers come first, because names of files are wide and may be outside the visible region.
const COLUMNS: [(&str, &str); 8] = [
    ("point", "Letter of its set in the scene, and its number; click to move the camera there"),
    ("station", "Station that took the reading"),
    ("x (mm)", "Position by this station minus the mean of the stations, in station 1's frame"),
    ("y (mm)", "The same difference along y"),
    ("z (mm)", "The same difference along z (up)"),
    ("3D (mm)", "Distance from the mean of the stations"),
    ("used", "Points that the calibration uses; the others check it independently"),
    ("set", "File that it was read from"),
];

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let Some((open, analysis)) = state.analysed() else {
        ui.weak("Nothing open.");
        return;
    };
    let points = residuals(&open.deployment, analysis);
    egui::Frame::new().inner_margin(8.0).show(ui, |ui| {
        if points.is_empty() {
            ui.label(why_none(state));
            return;
        }
        let what = "Position by each station minus the mean of the stations, in station 1's frame.";
        ui.label(RichText::new(what).small().weak());
        // A visible scroll bar shows that there are more columns.
        let solid = egui::style::ScrollStyle::solid();
        ui.spacing_mut().scroll = egui::style::ScrollStyle { handle_min_length: 0.0, ..solid };
        egui::ScrollArea::horizontal().auto_shrink(false).show(ui, |ui| {
            // The header does not scroll with the rows, so both have columns of fixed width.
            grid("heads of control points").show(ui, |ui| {
                for (title, hint) in COLUMNS {
                    let text = RichText::new(title).small().weak();
                    if title.ends_with("(mm)") {
                        right_aligned(ui, text, FIGURES).on_hover_text(hint);
                    } else {
                        ui.label(text).on_hover_text(hint);
                    }
                }
                ui.end_row();
            });
            egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                grid("control points").striped(true).show(ui, |ui| {
                    for point in &points {
                        rows(ui, point, commands);
                    }
                });
            });
        });
    });
}

fn grid(name: &str) -> egui::Grid {
    egui::Grid::new(name).min_col_width(COLUMN).spacing([6.0, 2.0])
}

/// Shows a row for each station that measured the point.
fn rows(ui: &mut egui::Ui, point: &PointResidual, commands: &mut Commands) {
    let dark = ui.visuals().dark_mode;
    let stations = (point.residuals_m.iter().enumerate()).filter_map(|(k, own)| Some((k, (*own)?)));
    for (row, (station, residual_m)) in stations.enumerate() {
        if row == 0 {
            let button = ui.add(egui::Button::new(RichText::new(&point.name).strong()).small());
            let name = format!("Go to control point {}", point.name);
            button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
            if button.on_hover_text(name).clicked() {
                let (file, marker) = (point.file.clone(), point.marker);
                commands.push(SceneCommand::LookAtPoint { file, marker }.into());
            }
        } else {
            ui.weak(&point.name);
        }
        let colour = theme::readable(palette::station(station), dark);
        ui.label(RichText::new((station + 1).to_string()).color(colour));
        for axis_m in residual_m.iter() {
            number_cell(ui, format!("{:+.2}", 1e3 * axis_m), FIGURES);
        }
        number_cell(ui, format!("{:.2}", 1e3 * residual_m.norm()), FIGURES);
        if row == 0 {
            ui.label(match (point.used, point.pillar) {
                (true, _) => "used",
                (false, true) => "pillar",
                (false, false) => "no",
            });
            ui.label(&point.file);
        }
        ui.end_row();
    }
}

fn why_none(state: &State) -> &'static str {
    let Some((open, analysis)) = state.analysed() else { return "" };
    match &analysis.answer {
        _ if open.deployment.control_points.is_empty() => {
            "This deployment has no control points. Add them in the Deployment pane, under Corrections."
        }
        Err(_) => "No result places the control points.",
        Ok(answer) if answer.calibration.placing_control_points(&open.deployment).is_none() => {
            "This result is in the frame of the tracks, in which the control points have no position."
        }
        Ok(_) => "No control point was measured by two stations.",
    }
}
