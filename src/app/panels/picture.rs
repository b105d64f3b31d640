//! The dialog for a picture of a pane.

use egui::{ComboBox, DragValue};

use crate::app::model::{
    Commands, DialogCommand, Pane, PictureFormat, PictureOrder, PictureTo, WorkspaceCommand,
};
use crate::app::state::State;

const WIDTH: f32 = 380.0;
const NO_SVG: &str = "The scene is drawn by the graphics device, as pixels only";

pub fn ui(ctx: &egui::Context, state: &State, order: &PictureOrder, commands: &mut Commands) {
    let modal = egui::Modal::new(egui::Id::unique("picture"))
        .frame(egui::Frame::popup(&ctx.global_style()).inner_margin(12.0));
    let mut chosen = *order;
    let response = modal.show(ctx, |ui| {
        ui.set_width(WIDTH.min(ui.ctx().content_rect().width() - 40.0));
        ui.heading("Picture of a pane");
        ui.add_space(4.0);
        let grid = egui::Grid::new("picture").num_columns(2).spacing([10.0, 8.0]);
        grid.show(ui, |ui| choices(ui, state, &mut chosen));
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            if ui.button("Cancel").clicked() {
                commands.push(DialogCommand::CloseOverlay.into());
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                for (name, to) in [("Save…", PictureTo::File), ("Copy", PictureTo::Clipboard)] {
                    if ui.button(name).clicked() {
                        commands.push(DialogCommand::CloseOverlay.into());
                        commands.push(WorkspaceCommand::TakePicture(chosen, to).into());
                    }
                }
            });
        });
    });
    if response.should_close() {
        commands.push(DialogCommand::CloseOverlay.into());
    } else if chosen != *order {
        commands.push(DialogCommand::EditPicture(chosen).into());
    }
}

fn choices(ui: &mut egui::Ui, state: &State, chosen: &mut PictureOrder) {
    let before = chosen.pane;
    let place = |pane: Pane| state.workspace.layout.place(pane);
    ui.label("Pane");
    let combo = ComboBox::from_id_salt("pane").selected_text(before.title());
    combo.height(400.0).show_ui(ui, |ui| {
        for pane in Pane::ALL {
            ui.selectable_value(&mut chosen.pane, pane, pane.title());
        }
    });
    ui.end_row();
    if chosen.pane != before {
        chosen.size_points = PictureOrder::size_of(place(chosen.pane));
    }
    let has_svg = PictureOrder::has_svg(chosen.pane);
    if !has_svg {
        chosen.format = PictureFormat::Png;
    }
    ui.label("Format");
    ui.horizontal(|ui| {
        for format in PictureFormat::ALL {
            let possible = has_svg || format == PictureFormat::Png;
            ui.add_enabled_ui(possible, |ui| {
                ui.radio_value(&mut chosen.format, format, format.name())
                    .on_disabled_hover_text(NO_SVG);
            });
        }
    });
    ui.end_row();
    ui.label("Size");
    ui.horizontal(|ui| {
        let [least, most] = PictureOrder::SIDES;
        let [width, height] = &mut chosen.size_points;
        ui.add(DragValue::new(width).range(least..=most).suffix(" wide"));
        ui.label("×");
        ui.add(DragValue::new(height).range(least..=most).suffix(" high"));
        let shown = PictureOrder::size_of(place(chosen.pane));
        if ui.add_enabled(chosen.size_points != shown, egui::Button::new("as shown")).clicked() {
            chosen.size_points = shown;
        }
    });
    ui.end_row();
    ui.label("Scale");
    ui.add_enabled_ui(chosen.format == PictureFormat::Png, |ui| {
        ui.horizontal(|ui| scales(ui, chosen));
    });
    ui.end_row();
    ui.label("Colours");
    ui.horizontal(|ui| {
        ui.radio_value(&mut chosen.dark, false, "light");
        ui.radio_value(&mut chosen.dark, true, "dark");
    });
    ui.end_row();
}

fn scales(ui: &mut egui::Ui, chosen: &mut PictureOrder) {
    for scale in 1..=PictureOrder::MOST_SCALE {
        ui.selectable_value(&mut chosen.scale, scale, format!("{scale}×"));
    }
    match chosen.format {
        PictureFormat::Png => {
            let [width, height] = chosen.size_pixels();
            ui.weak(format!("{width} × {height} pixels"));
        }
        PictureFormat::Svg => {
            ui.weak("of any size");
        }
    }
}
