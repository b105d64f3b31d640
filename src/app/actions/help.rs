//! The menu of help.

use egui::Key;

use super::{Action, Menu};
use crate::app::model::{DialogCommand, Pane, WorkspaceCommand};

pub fn actions() -> [Action; 5] {
    [
        Action::new(Menu::Help, "", "Command palette…", DialogCommand::ShowPalette)
            .hint("Type what you want to do")
            .ctrl(Key::P),
        Action::new(
            Menu::Help,
            "",
            "Guide: from your data to a result",
            WorkspaceCommand::ShowPane(Pane::Guide),
        )
        .hint("All steps, each with its command"),
        Action::new(Menu::Help, "", "Glossary", DialogCommand::Explain)
            .hint("F1 explains the term under the pointer or in focus")
            .key(Key::F1),
        Action::new(Menu::Help, "", "Keyboard and mouse", DialogCommand::ShowShortcuts)
            .hint("All keys, and mouse actions in the scene and the plots")
            .key(Key::Questionmark),
        Action::new(Menu::Help, "", "Licences", DialogCommand::ShowLicences)
            .hint("Those of the program and of the packages in it"),
    ]
}
