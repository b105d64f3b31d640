//! The menu of help.

use egui::Key;

use super::{Action, Menu};
use crate::app::model::{DialogCommand, Pane, WorkspaceCommand};

pub fn actions() -> [Action; 4] {
    [
        Action::new(Menu::Help, "", "Command palette…", DialogCommand::ShowPalette)
            .hint("Type what you want to do")
            .ctrl(Key::P),
        Action::new(
            Menu::Help,
            "",
            "Guide: from your data to an answer",
            WorkspaceCommand::ShowPane(Pane::Guide),
        )
        .hint("What to do, step by step, with what does it"),
        Action::new(Menu::Help, "", "Words, explained", DialogCommand::Explain)
            .hint("F1 explains the word under the pointer, or the one that has the focus")
            .key(Key::F1),
        Action::new(Menu::Help, "", "Keyboard and mouse", DialogCommand::ShowShortcuts)
            .hint("All keys, and what the mouse does in the scene and in the plots")
            .key(Key::Questionmark),
    ]
}
