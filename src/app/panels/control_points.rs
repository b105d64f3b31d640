//! The control points, one by one: what each station makes of them, and whether the answer rests on them.

use egui::{RichText, Role, WidgetInfo};

use crate::app::model::{Commands, Pane, SceneCommand, WorkspaceCommand};
use crate::app::prepared::control_points::{PointResidual, residuals};
use crate::app::state::State;
use crate::app::theme;
use resect_core::palette;

/// Width of a column with room for a name or a number (points).
const COLUMN: f32 = 50.0;

/// Numbers first: names of files are wide, and may be out of sight.
const COLUMNS: [(&str, &str); 8] = [
    (
        "point",
        "The letter of its set in the scene, and its number; a click brings the camera to it",
    ),
    ("station", "The station whose reading it is"),
    ("x (mm)", "What the station makes of it, from the mean of the stations, in station 1's frame"),
    ("y (mm)", "The same along y"),
    ("z (mm)", "The same upwards"),
    ("3D (mm)", "How far the station's version is from the mean"),
    ("used", "Whether the answer rests on it; what it does not rest on tells whether it is right"),
    ("set", "The file it was read from"),
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
        let what = "Each station's version minus the mean of the stations, in station 1's frame.";
        ui.label(RichText::new(what).small().weak());
        // What is to the right of the edge must be seen to be there.
        let solid = egui::style::ScrollStyle::solid();
        ui.spacing_mut().scroll = egui::style::ScrollStyle { handle_min_length: 0.0, ..solid };
        egui::ScrollArea::horizontal().auto_shrink(false).show(ui, |ui| {
            // The heads stay where the rows scroll, so both have columns of one width.
            grid("heads of control points").show(ui, |ui| {
                for (title, hint) in COLUMNS {
                    let text = RichText::new(title).small().weak();
                    if title.ends_with("(mm)") {
                        number_cell(ui, text).on_hover_text(hint);
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

/// A number, or the head of a column of them, to the right of its column.
fn number_cell(ui: &mut egui::Ui, text: RichText) -> egui::Response {
    let (rect, _) = ui.allocate_exact_size(
        egui::vec2(COLUMN, ui.spacing().interact_size.y),
        egui::Sense::hover(),
    );
    let layout = egui::Layout::right_to_left(egui::Align::Center);
    ui.new_child(egui::UiBuilder::new().max_rect(rect).layout(layout)).label(text)
}

/// A row for each station that measured the point.
fn rows(ui: &mut egui::Ui, point: &PointResidual, commands: &mut Commands) {
    let dark = ui.visuals().dark_mode;
    let stations = (0..3).filter_map(|station| Some((station, point.residuals_m[station]?)));
    for (row, (station, residual_m)) in stations.enumerate() {
        if row == 0 {
            let button = ui.add(egui::Button::new(RichText::new(&point.name).strong()).small());
            let name = format!("Come to control point {}", point.name);
            button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
            if button.on_hover_text(name).clicked() {
                commands.push(WorkspaceCommand::ShowPane(Pane::Scene).into());
                commands.push(SceneCommand::ComeTo(point.mean_m).into());
            }
        } else {
            ui.weak(&point.name);
        }
        let colour = theme::readable(palette::STATIONS[station], dark);
        ui.label(RichText::new((station + 1).to_string()).color(colour));
        for axis_m in residual_m.iter() {
            number_cell(ui, RichText::new(format!("{:+.2}", 1e3 * axis_m)).monospace());
        }
        number_cell(ui, RichText::new(format!("{:.2}", 1e3 * residual_m.norm())).monospace());
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
            "This deployment has no control points; the Deployment pane adds them under Put right."
        }
        Err(_) => "There is no answer that places the control points.",
        Ok(answer) if answer.calibration.placing_control_points(&open.deployment).is_none() => {
            "This answer is about the frame of the tracks, in which the control points have no place."
        }
        Ok(_) => "No control point was measured by two stations.",
    }
}
