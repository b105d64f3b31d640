//! Commands from keys.

use egui::{Key, KeyboardShortcut, Modifiers};

use super::all;
use crate::app::model::{Command, Commands};
use crate::app::state::State;

/// Formats a shortcut with the keyboard's labels: Ctrl+P, ?.
pub fn keys_in_words(ctx: &egui::Context, keys: &KeyboardShortcut) -> String {
    ctx.format_shortcut(keys).replace("Questionmark", "?")
}

/// Adds the commands of the keys pressed in this frame. A focused widget receives keys without Ctrl, and an open menu receives Escape.
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
    // Ctrl+Z would also match Ctrl+Shift+Z.
    keyed.sort_by_key(|(keys, _)| std::cmp::Reverse(keys.modifiers.shift));
    for (keys, command) in keyed {
        let plain = keys.modifiers.is_none() || keys.modifiers == Modifiers::SHIFT;
        // A focused widget receives arrows and the space bar, a text field also letters; F1 always explains.
        let typing = typing && keys.logical_key != Key::F1;
        let taken = plain && (typing || (focused && works_widgets(keys.logical_key)))
            || menu_is_open && keys.logical_key == Key::Escape;
        if !taken && ctx.input_mut(|input| input.consume_shortcut(&keys)) {
            // The menu would cover what the key opens.
            egui::Popup::close_all(ctx);
            commands.push(command);
        }
    }
}

fn works_widgets(key: Key) -> bool {
    use Key::{ArrowDown, ArrowLeft, ArrowRight, ArrowUp, End, Enter, Home, Space};
    matches!(key, ArrowDown | ArrowLeft | ArrowRight | ArrowUp | End | Enter | Home | Space)
}
