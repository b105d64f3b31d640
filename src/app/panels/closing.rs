//! The question before a window closes whose session is not saved.

use crate::app::model::{Commands, DialogCommand, SessionCommand, WorkspaceCommand};
use crate::app::state::State;

const WIDTH: f32 = 440.0;

pub fn ui(ctx: &egui::Context, state: &State, commands: &mut Commands) {
    let modal = egui::Modal::new(egui::Id::unique("closing"))
        .frame(egui::Frame::popup(&ctx.global_style()).inner_margin(12.0));
    let response = modal.show(ctx, |ui| {
        ui.set_width(WIDTH.min(ui.ctx().content_rect().width() - 40.0));
        ui.heading("Save the session before the window closes?");
        ui.label(
            "It has changes that no session file contains. Without saving, File › Reopen the last session brings it back, until \
             another session replaces it.",
        );
        if state.live.is_running() {
            ui.label("The live run ends; its recording is kept.");
        }
        let mut asks = state.workspace.asks_before_closing;
        if ui.checkbox(&mut asks, "Ask before a window with an unsaved session closes").changed() {
            commands.push(WorkspaceCommand::AskBeforeClosing(asks).into());
        }
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            if ui.button("Cancel").clicked() {
                commands.push(DialogCommand::CloseOverlay.into());
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button("Save…").clicked() {
                    commands.push(DialogCommand::CloseOverlay.into());
                    commands.push(SessionCommand::Save.into());
                }
                if ui.button("Close without saving").clicked() {
                    commands.push(WorkspaceCommand::Close.into());
                }
            });
        });
    });
    if response.should_close() {
        commands.push(DialogCommand::CloseOverlay.into());
    }
}
