//! Content of the scene's pane while nothing is open: a description of the program, and the first steps.

use egui::RichText;

use crate::app::model::{Commands, DeploymentCommand, Pane, WorkspaceCommand};
use crate::app::state::SessionState;
use resect_io::sample::Sample;

const WIDTH: f32 = 460.0;
const MOST_RECENT: usize = 5;

const STEPS: [(&str, &str); 3] = [
    (
        "Open a deployment",
        "A folder, a ROS 1 or ROS 2 bag, or a CSV of polar measurements (timestamp, id, distance, ha, va). Control points, rig and \
         GNSS beside it are recognised by their content.",
    ),
    (
        "Look and tune",
        "The scene and the plots show if each reading is used or rejected. Each filter on the left has a switch and sliders.",
    ),
    (
        "Read the verdict",
        "On the right: good, weak, ambiguous or degenerate, the reasons, and the transforms with their uncertainty.",
    ),
];

pub fn ui(ui: &mut egui::Ui, session: &SessionState, commands: &mut Commands) {
    egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        let width = WIDTH.min(ui.available_width() - 24.0);
        let margin = ((ui.available_width() - width) / 2.0).max(12.0);
        ui.add_space((ui.available_height() / 10.0).clamp(8.0, 60.0));
        let column = egui::Margin { left: margin as i8, ..egui::Margin::ZERO };
        // A margin is limited to small values; the remaining width is added as space.
        let left = margin - f32::from(column.left);
        ui.horizontal_top(|ui| {
            ui.add_space(left);
            egui::Frame::new().inner_margin(column).show(ui, |ui| {
                ui.vertical(|ui| {
                    ui.set_width(width);
                    content(ui, session, commands);
                });
            });
        });
    });
}

fn content(ui: &mut egui::Ui, session: &SessionState, commands: &mut Commands) {
    ui.heading("resect");
    ui.label(
        "Estimates the relative poses of robotic total stations, and how reliable the result is.",
    );
    ui.add_space(10.0);
    for (number, (what, how)) in STEPS.iter().enumerate() {
        ui.label(RichText::new(format!("{}  {what}", number + 1)).strong());
        ui.indent(number, |ui| ui.label(*how));
        ui.add_space(2.0);
    }
    ui.add_space(8.0);
    ui.horizontal_wrapped(|ui| {
        if ui.button("Open folder…").clicked() {
            commands.push(DeploymentCommand::OpenFolderDialog.into());
        }
        if ui.button("Open file…").clicked() {
            commands.push(DeploymentCommand::OpenFileDialog.into());
        }
        ui.label("or drop files anywhere on the window");
    });
    ui.horizontal_wrapped(|ui| {
        if ui.button("Show the guide").on_hover_text("All steps in order").clicked() {
            commands.push(WorkspaceCommand::ShowPane(Pane::Guide).into());
        }
        ui.label("from your data to a reliable result");
    });
    ui.add_space(10.0);
    ui.strong("No data at hand?");
    ui.horizontal_wrapped(|ui| {
        for sample in Sample::ALL {
            let button = ui.button(format!("Try {}", sample.title()));
            if button.on_hover_text("A simulated deployment, built into the program").clicked() {
                commands.push(DeploymentCommand::OpenSample(sample).into());
            }
        }
    });
    if session.recent.is_empty() {
        return;
    }
    ui.add_space(10.0);
    ui.strong("Recent");
    for (recent, name) in session.recent.iter().zip(session.recent_names()).take(MOST_RECENT) {
        let source = &recent.source;
        let where_it_is = source.path().map_or(String::new(), |path| path.display().to_string());
        if ui.link(name).on_hover_text(where_it_is).clicked() {
            commands.push(DeploymentCommand::OpenSource(source.clone()).into());
        }
    }
}
