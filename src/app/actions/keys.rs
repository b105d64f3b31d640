//! Commands from keys.

use egui::{Key, KeyboardShortcut, Modifiers};

use super::all;
use crate::app::model::{Command, Commands};
use crate::app::state::State;

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
