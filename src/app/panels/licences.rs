//! The licences of the program and of the packages in it.

use crate::app::model::{Commands, DialogCommand};

const SIZE: egui::Vec2 = egui::Vec2::new(680.0, 620.0);

/// `lines` are those of the text.
pub fn ui(ctx: &egui::Context, lines: &[String], commands: &mut Commands) {
    let modal = egui::Modal::new(egui::Id::unique("licences"));
    let response = modal.show(ctx, |ui| {
        let size = SIZE.min(ui.ctx().content_rect().size() - egui::vec2(60.0, 120.0));
        ui.set_width(size.x);
        ui.horizontal(|ui| {
            ui.heading("Licences");
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button("Close").clicked() {
                    commands.push(DialogCommand::CloseOverlay.into());
                }
            });
        });
        // Only the rows in sight are laid out, because there are ten thousand.
        let row = ui.text_style_height(&egui::TextStyle::Small);
        let height = size.y - 60.0;
        let list = egui::ScrollArea::both().auto_shrink(false).max_height(height);
        list.min_scrolled_height(height).show_rows(ui, row, lines.len(), |ui, rows| {
            for line in &lines[rows] {
                ui.add(egui::Label::new(egui::RichText::new(line).small()).extend());
            }
        });
    });
    if response.should_close() {
        commands.push(DialogCommand::CloseOverlay.into());
    }
}
