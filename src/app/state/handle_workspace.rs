//! The window itself: panes, units, colours, clipboard and toasts.

use super::State;
use crate::app::layout::Layout;
use crate::app::model::WorkspaceCommand;
use crate::app::theme;

impl State {
    pub(super) fn handle_workspace(&mut self, command: WorkspaceCommand, ctx: &egui::Context) {
        use WorkspaceCommand as Command;
        let workspace = &mut self.workspace;
        match command {
            Command::ShowPane(pane) => workspace.layout.show(pane),
            Command::UseLayout(preset) => workspace.layout = Layout::from(preset),
            Command::ResetLayout => workspace.layout = Layout::default(),
            Command::SetUnits(units) => workspace.units = units,
            Command::UseTheme(theme) => {
                ctx.set_theme(theme);
                workspace.theme = theme;
            }
            Command::ReadInTheSun(on) => {
                theme::in_the_sun(ctx, on);
                workspace.in_the_sun = on;
            }
            Command::Copy(text) => {
                ctx.copy_text(text);
                self.toasts.done("copied");
            }
            Command::DismissToast(id) => self.toasts.dismiss(id),
            Command::HoldToast(id) => self.toasts.hold(id),
        }
    }
}
