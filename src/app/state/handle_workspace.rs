//! The window itself: panes, units, colours, clipboard and toasts.

use super::State;
use crate::app::layout::Layout;
use crate::app::model::{Pane, PictureOrder, PictureTo, SettingFocus, WorkspaceCommand};
use crate::app::theme;

impl State {
    pub(super) fn handle_workspace(&mut self, command: WorkspaceCommand, ctx: &egui::Context) {
        use WorkspaceCommand as Command;
        let workspace = &mut self.workspace;
        match command {
            Command::ShowPane(pane) => workspace.layout.show(pane),
            Command::UseLayout(preset) => {
                (workspace.layout, workspace.before_evaluation) = (preset.into(), None);
            }
            Command::ResetLayout => {
                (workspace.layout, workspace.before_evaluation) = (Layout::default(), None);
            }
            Command::SetUnits(units) => workspace.units = units,
            Command::UseTheme(theme) => {
                ctx.set_theme(theme);
                workspace.theme = theme;
            }
            Command::ReadInTheSun(on) => {
                theme::in_the_sun(ctx, on);
                workspace.in_the_sun = on;
            }
            Command::FocusSetting(key) => {
                workspace.layout.show(Pane::Pipeline);
                workspace.focused_setting = Some(SettingFocus::Handle(key));
            }
            Command::SettingFocused(SettingFocus::Handle(key)) => {
                workspace.focused_setting = Some(SettingFocus::Field(key));
                ctx.request_repaint();
            }
            Command::SettingFocused(SettingFocus::Field(_)) => workspace.focused_setting = None,
            Command::AskBeforeClosing(asks) => workspace.asks_before_closing = asks,
            Command::Close => {
                workspace.closes = true;
                ctx.send_viewport_cmd(egui::ViewportCommand::Close);
            }
            Command::Copy(text) => {
                ctx.copy_text(text);
                self.toasts.done("copied");
            }
            Command::TakePicture(order, to) => {
                workspace.wanted_picture = Some((order, to));
                ctx.request_repaint();
            }
            Command::CopyPicture(pane) => {
                let order = PictureOrder::of(
                    pane,
                    workspace.layout.place(pane),
                    ctx.theme() == egui::Theme::Dark,
                );
                workspace.wanted_picture = Some((order, PictureTo::Clipboard));
                ctx.request_repaint();
            }
            Command::DismissToast(id) => self.toasts.dismiss(id),
            Command::HoldToast(id) => self.toasts.hold(id),
        }
    }
}
