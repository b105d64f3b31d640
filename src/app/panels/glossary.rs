//! The glossary: the terms on which F1 was pressed, or all terms that match a query.

use crate::app::model::{Commands, DialogCommand, Lookup};
use crate::app::theme;
use crate::app::words;
use resect_report::glossary;

const SIZE: egui::Vec2 = egui::Vec2::new(560.0, 620.0);

pub fn ui(ctx: &egui::Context, lookup: &Lookup, commands: &mut Commands) {
    let mut edited = lookup.clone();
    let modal = egui::Modal::new(egui::Id::unique("glossary"));
    let response = modal.show(ctx, |ui| {
        let size = SIZE.min(ui.ctx().content_rect().size() - egui::vec2(60.0, 120.0));
        ui.set_width(size.x);
        ui.horizontal(|ui| {
            ui.heading("Glossary");
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button("Close").clicked() {
                    commands.push(DialogCommand::CloseOverlay.into());
                }
            });
        });
        let field = egui::TextEdit::singleline(&mut edited.query)
            .hint_text("A term, or a word of its explanation")
            .desired_width(f32::INFINITY);
        ui.add(field).accessible_name("Word").request_focus();
        // Escape inside the text field only releases its focus.
        if ui.input(|input| input.key_pressed(egui::Key::Escape)) {
            commands.push(DialogCommand::CloseOverlay.into());
        }
        ui.add_space(4.0);
        let some = edited.query.trim().is_empty() && !edited.of.is_empty();
        let found = if some { edited.of.clone() } else { glossary::matching(&edited.query) };
        let height = size.y - 90.0;
        // A dialog gets no more room than in the last frame, but the next letter may find more terms.
        theme::keep_handle(ui);
        let list = egui::ScrollArea::vertical().auto_shrink([false, true]).max_height(height);
        list.min_scrolled_height(height).show(ui, |ui| {
            for term in &found {
                words::entry(ui, term);
                ui.add_space(8.0);
            }
        });
        if found.is_empty() {
            ui.weak("No matching term.");
        }
        if some && ui.button("All terms").clicked() {
            edited.of.clear();
        }
    });
    if response.should_close() {
        commands.push(DialogCommand::CloseOverlay.into());
    } else if edited != *lookup {
        commands.push(DialogCommand::LookUp(edited).into());
    }
}
