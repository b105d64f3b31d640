//! Dialogs, questions, and sheets above the panes.

use super::State;
use crate::app::model::{DialogCommand, Lookup, Overlay, Palette, PictureOrder};
use crate::app::words;

impl State {
    pub(super) fn handle_dialog(&mut self, command: DialogCommand, ctx: &egui::Context) {
        use DialogCommand as Command;
        match command {
            Command::Prompt(command) => self.answer_prompt(command),
            Command::HoverPaths(paths) => self.hover_paths(paths),
            Command::EditAsked(asked) => self.edit_asked(asked),
            Command::AnswerAsked(answer) => self.answer_asked(answer),
            Command::CancelAsked => self.cancel_asked(),
            Command::ShowPalette => self.dialogs.overlay = Overlay::Palette(Palette::default()),
            Command::EditPalette(palette) => self.dialogs.overlay = Overlay::Palette(palette),
            Command::ShowShortcuts => self.dialogs.overlay = Overlay::Shortcuts,
            Command::ShowPicture(pane) => {
                let place = self.workspace.layout.place(pane);
                let dark = ctx.theme() == egui::Theme::Dark;
                self.dialogs.overlay = Overlay::Picture(PictureOrder::of(pane, place, dark));
            }
            Command::EditPicture(order) => self.dialogs.overlay = Overlay::Picture(order),
            Command::Explain => {
                let of = words::pointed_at(ctx);
                self.dialogs.overlay = Overlay::Glossary(Lookup { of, ..Lookup::default() });
            }
            Command::LookUp(lookup) => self.dialogs.overlay = Overlay::Glossary(lookup),
            Command::ShowLicences => {
                let lines = crate::licences::text().lines().map(str::to_owned).collect();
                self.dialogs.overlay = Overlay::Licences(lines);
            }
            Command::CloseOverlay => self.dialogs.overlay = Overlay::None,
        }
    }
}
