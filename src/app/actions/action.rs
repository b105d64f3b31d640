//! An entry of a menu with its name, shortcut and command.

use egui::{Key, KeyboardShortcut, Modifiers};

use crate::app::model::Command;

/// The menus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Menu {
    File,
    Edit,
    Time,
    View,
    Export,
    Help,
    /// The numbers of the Pipeline pane, which are in no menu.
    Pipeline,
}

impl Menu {
    /// The menus of the bar.
    pub const ALL: [Self; 6] =
        [Self::File, Self::Edit, Self::Time, Self::View, Self::Export, Self::Help];

    pub fn title(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::Time => "Time",
            Self::View => "View",
            Self::Export => "Export",
            Self::Help => "Help",
            Self::Pipeline => "Pipeline",
        }
    }
}

/// An action of the user.
#[derive(Clone, Debug)]
pub struct Action {
    pub menu: Menu,
    /// Heading in the menu; the actions of a section are adjacent.
    pub section: &'static str,
    pub name: String,
    /// General meaning of the shortcut, for the shortcut sheet; empty if the name contains it.
    pub in_general: &'static str,
    pub hint: &'static str,
    /// Further words by which the palette finds the action.
    pub also: &'static str,
    pub shortcut: Option<KeyboardShortcut>,
    /// State of a choice or switch; `None` for other actions.
    pub on: Option<bool>,
    /// True if the actions of its section share one row of the menu, each labelled by its last word.
    pub in_a_row: bool,
    /// `None` while the action is not available.
    pub command: Option<Command>,
}

impl Action {
    pub(super) fn new(
        menu: Menu,
        section: &'static str,
        name: impl Into<String>,
        command: impl Into<Command>,
    ) -> Self {
        Self {
            menu,
            section,
            name: name.into(),
            in_general: "",
            hint: "",
            also: "",
            shortcut: None,
            on: None,
            in_a_row: false,
            command: Some(command.into()),
        }
    }

    pub(super) fn hint(self, hint: &'static str) -> Self {
        Self { hint, ..self }
    }

    pub(super) fn also(self, also: &'static str) -> Self {
        Self { also, ..self }
    }

    pub(super) fn in_general(self, in_general: &'static str) -> Self {
        Self { in_general, ..self }
    }

    /// Adds a shortcut with Ctrl (⌘ on a Mac).
    pub(super) fn ctrl(self, key: Key) -> Self {
        self.keys(Modifiers::COMMAND, key)
    }

    pub(super) fn key(self, key: Key) -> Self {
        self.keys(Modifiers::NONE, key)
    }

    pub(super) fn keys(self, modifiers: Modifiers, key: Key) -> Self {
        Self { shortcut: Some(KeyboardShortcut::new(modifiers, key)), ..self }
    }

    pub(super) fn on(self, on: bool) -> Self {
        Self { on: Some(on), ..self }
    }

    /// Makes it one of a few mutually exclusive actions.
    pub(super) fn one_of(self, on: bool) -> Self {
        Self { on: Some(on), in_a_row: true, ..self }
    }

    pub(super) fn possible(self, possible: bool) -> Self {
        Self { command: self.command.filter(|_| possible), ..self }
    }
}
