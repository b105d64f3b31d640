//! Actions for moving through time.

use egui::{Key, Modifiers};

use super::{Action, Menu};
use crate::app::model::TimeCommand;
use crate::app::state::State;

/// Length of a step with Shift.
const LONG_STEP: i32 = 10;

pub fn actions(state: &State) -> Vec<Action> {
    let timeline = state.active().map(|open| &open.timeline);
    let time = |section, name: &str, command| {
        Action::new(Menu::Time, section, name, command).possible(timeline.is_some())
    };
    let play = if state.time.playback.playing { "Pause" } else { "Play" };
    let ends_s = timeline.map_or([0.0; 2], |timeline| timeline.whole_s);
    let selected = timeline.is_some_and(|timeline| timeline.selection_s.is_some());
    vec![
        time("", play, TimeCommand::TogglePlay)
            .hint("Moves the cursor through the selection or the shown times")
            .key(Key::Space),
        time("Cursor", "Step forwards", TimeCommand::StepCursor(1))
            .hint("To the next triplet")
            .key(Key::ArrowRight),
        time("Cursor", "Step backwards", TimeCommand::StepCursor(-1)).key(Key::ArrowLeft),
        time("Cursor", "Ten steps forwards", TimeCommand::StepCursor(LONG_STEP))
            .keys(Modifiers::SHIFT, Key::ArrowRight),
        time("Cursor", "Ten steps backwards", TimeCommand::StepCursor(-LONG_STEP))
            .keys(Modifiers::SHIFT, Key::ArrowLeft),
        time("Cursor", "To the start", TimeCommand::MoveCursor(ends_s[0])).key(Key::Home),
        time("Cursor", "To the end", TimeCommand::MoveCursor(ends_s[1])).key(Key::End),
        time("Window", "Show all times", TimeCommand::ShowAllTimes)
            .hint("In every plot over time")
            .key(Key::A),
        time("Window", "Zoom to the selection", TimeCommand::ZoomToSelection)
            .key(Key::Z)
            .possible(selected),
        time("Window", "Clear the selection", TimeCommand::Select(None))
            .key(Key::Escape)
            .possible(selected),
    ]
}
