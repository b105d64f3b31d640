//! Everything that can be done by menu, palette or key, in one table: the menus, the command palette and the sheet
//! of shortcuts are all drawn from it, so that none of them can forget one.

mod edit;
mod file;
pub mod remedies;
mod time;
mod view;

use egui::{Key, KeyboardShortcut, Modifiers};

use super::state::State;
use crate::app::model::{Command, Commands, Pane};

/// The menus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Menu {
    File,
    Edit,
    Time,
    View,
    Export,
    Help,
}

impl Menu {
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
        }
    }
}

/// Something that can be done.
#[derive(Clone, Debug)]
pub struct Action {
    pub menu: Menu,
    /// Heading in the menu; actions of a section follow each other.
    pub section: &'static str,
    pub name: String,
    /// What its key does whatever is open, for the sheet of shortcuts; empty where the name says it.
    pub in_general: &'static str,
    pub hint: &'static str,
    pub shortcut: Option<KeyboardShortcut>,
    /// Whether the action's choice or switch is on; `None` where it is neither.
    pub on: Option<bool>,
    /// Whether the actions of its section stand in one row of the menu, each by its last word.
    pub in_a_row: bool,
    /// `None` while it cannot be done.
    pub command: Option<Command>,
}

impl Action {
    fn new(menu: Menu, section: &'static str, name: impl Into<String>, command: Command) -> Self {
        Self {
            menu,
            section,
            name: name.into(),
            in_general: "",
            hint: "",
            shortcut: None,
            on: None,
            in_a_row: false,
            command: Some(command),
        }
    }

    fn hint(self, hint: &'static str) -> Self {
        Self { hint, ..self }
    }

    fn in_general(self, in_general: &'static str) -> Self {
        Self { in_general, ..self }
    }

    /// The key that comes with Ctrl (⌘ on a Mac).
    fn ctrl(self, key: Key) -> Self {
        self.keys(Modifiers::COMMAND, key)
    }

    fn key(self, key: Key) -> Self {
        self.keys(Modifiers::NONE, key)
    }

    fn keys(self, modifiers: Modifiers, key: Key) -> Self {
        Self { shortcut: Some(KeyboardShortcut::new(modifiers, key)), ..self }
    }

    fn on(self, on: bool) -> Self {
        Self { on: Some(on), ..self }
    }

    /// Makes it one of a few actions that exclude each other.
    fn one_of(self, on: bool) -> Self {
        Self { on: Some(on), in_a_row: true, ..self }
    }

    fn possible(self, possible: bool) -> Self {
        Self { command: self.command.filter(|_| possible), ..self }
    }
}

/// All there is to do in this state, in the order of the menus.
pub fn all(state: &State) -> Vec<Action> {
    let mut actions = file::actions(state);
    actions.extend(edit::actions(state));
    actions.extend(remedies::actions(state));
    actions.extend(time::actions(state));
    actions.extend(view::actions(state));
    actions.extend(file::exports(state));
    actions.extend([
        Action::new(Menu::Help, "", "Command palette…", Command::ShowPalette)
            .hint("Type what you want to do")
            .ctrl(Key::P),
        Action::new(
            Menu::Help,
            "",
            "Guide: from your data to an answer",
            Command::ShowPane(Pane::Guide),
        )
        .hint("What to do, step by step, with what does it"),
        Action::new(Menu::Help, "", "Words, explained", Command::Explain)
            .hint("F1 explains the word under the pointer, or the one that has the focus")
            .key(Key::F1),
        Action::new(Menu::Help, "", "Keyboard and mouse", Command::ShowShortcuts)
            .hint("All keys, and what the mouse does in the scene and in the plots")
            .key(Key::Questionmark),
    ]);
    actions
}

/// Keys as they stand on a keyboard: Ctrl+P, ?.
pub fn keys_in_words(ctx: &egui::Context, keys: &KeyboardShortcut) -> String {
    ctx.format_shortcut(keys).replace("Questionmark", "?")
}

/// What the keys of this frame ask for. Keys without Ctrl are left to a widget that has the focus, and Escape to
/// a menu that is open.
pub fn from_keys(ctx: &egui::Context, state: &State, commands: &mut Commands) {
    let pressed = |event: &egui::Event| matches!(event, egui::Event::Key { pressed: true, .. });
    if !ctx.input(|input| input.events.iter().any(pressed)) {
        return;
    }
    let focused = ctx.memory(|memory| memory.focused().is_some());
    let typing = ctx.text_edit_focused();
    let menu_is_open = egui::Popup::is_any_open(ctx);
    let mut keyed: Vec<(KeyboardShortcut, Command)> = all(state)
        .into_iter()
        .filter_map(|action| Some((action.shortcut?, action.command?)))
        .collect();
    // Ctrl+Z would take Ctrl+Shift+Z's keys.
    keyed.sort_by_key(|(keys, _)| std::cmp::Reverse(keys.modifiers.shift));
    for (keys, command) in keyed {
        let plain = keys.modifiers.is_none() || keys.modifiers == Modifiers::SHIFT;
        // The arrows and the space bar work the widget that has the focus; letters only a text field; F1 neither.
        let typing = typing && keys.logical_key != Key::F1;
        let taken = plain && (typing || (focused && works_widgets(keys.logical_key)))
            || menu_is_open && keys.logical_key == Key::Escape;
        if !taken && ctx.input_mut(|input| input.consume_shortcut(&keys)) {
            // What the keys open must not stand behind a menu.
            egui::Popup::close_all(ctx);
            commands.push(command);
        }
    }
}

fn works_widgets(key: Key) -> bool {
    use Key::{ArrowDown, ArrowLeft, ArrowRight, ArrowUp, End, Enter, Home, Space};
    matches!(key, ArrowDown | ArrowLeft | ArrowRight | ArrowUp | End | Enter | Home | Space)
}

/// Actions that a query finds, the best first: every word of it is in the menu's title, the name or the hint.
pub fn matching(actions: &[Action], query: &str) -> Vec<Action> {
    let words: Vec<String> = query.split_whitespace().map(str::to_lowercase).collect();
    let mut found: Vec<(usize, &Action)> = actions
        .iter()
        .filter(|action| action.command.is_some())
        .filter_map(|action| {
            let name = action.name.to_lowercase();
            let all = format!(
                "{} {} {name} {}",
                action.menu.title().to_lowercase(),
                action.section.to_lowercase(),
                action.hint.to_lowercase()
            );
            // A word at the start of the name, at the start of a word of it, anywhere in it, elsewhere.
            let cost = |word: &String| match name.find(word.as_str()) {
                Some(0) => Some(0),
                Some(_) if name.contains(&format!(" {word}")) => Some(1),
                Some(_) => Some(2),
                None => all.contains(word.as_str()).then_some(5),
            };
            words.iter().map(cost).sum::<Option<usize>>().map(|cost| (cost, action))
        })
        .collect();
    found.sort_by_key(|(cost, _)| *cost);
    found.into_iter().map(|(_, action)| action.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state() -> State {
        State::new(egui::Context::default())
    }

    #[test]
    fn no_two_actions_share_keys_or_a_name() {
        let actions = all(&state());
        for (index, one) in actions.iter().enumerate() {
            for other in &actions[index + 1..] {
                assert!(
                    one.shortcut.is_none() || one.shortcut != other.shortcut,
                    "{} and {}",
                    one.name,
                    other.name
                );
                assert!(one.menu != other.menu || one.name != other.name, "{}", one.name);
            }
        }
    }

    #[test]
    fn the_actions_of_a_section_follow_each_other() {
        let actions = all(&state());
        let mut seen: Vec<(Menu, &str)> = Vec::new();
        for action in &actions {
            let place = (action.menu, action.section);
            if seen.last() != Some(&place) {
                assert!(!seen.contains(&place), "{place:?} comes twice");
                seen.push(place);
            }
        }
    }

    #[test]
    fn a_query_finds_by_words_in_any_order_and_puts_the_name_first() {
        let actions = all(&state());
        let found = matching(&actions, "folder open");
        assert_eq!(found[0].name, "Open folder…");
        let found = matching(&actions, "fit");
        assert_eq!(found[0].name, "Fit");
        assert_eq!(matching(&actions, "light")[0].name, "Theme: light");
        assert_eq!(matching(&actions, "gon")[0].name, "Angles in gon");
        assert!(matching(&actions, "no such thing").is_empty());
        for action in actions.iter().filter(|action| action.command.is_some()) {
            let words = format!("{} {} {}", action.menu.title(), action.name, action.hint);
            let found = matching(&actions, &words.to_uppercase());
            assert!(found.iter().any(|found| found.name == action.name), "{words}");
        }
        // What cannot be done now is not offered.
        assert!(matching(&actions, "undo").is_empty());
        assert_eq!(
            matching(&actions, "").len(),
            actions.iter().filter(|a| a.command.is_some()).count()
        );
    }
}
