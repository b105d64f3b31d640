//! Conversion of an act into events and frames.

use std::path::PathBuf;

use egui::{
    Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, Pos2, TouchPhase,
};
use resect::app::DialogCommand;
use resect::app::file_dialog::PromptCommand;

use super::act::Act;
use super::screen::Screen;

impl Screen {
    /// Performs a single act; those of the window's life are in `Life`.
    pub fn perform(&mut self, act: Act) {
        match act {
            Act::Move(at) => self.frame(vec![Event::PointerMoved(at)]),
            Act::Click { at, button, modifiers, times } => self.click(at, button, modifiers, times),
            Act::Drag { from, to, button, modifiers, frames } => {
                self.drag([from, to], button, modifiers, frames);
            }
            Act::Wheel { at, delta, modifiers } => {
                self.hold(modifiers);
                let wheel = Event::MouseWheel {
                    unit: MouseWheelUnit::Point,
                    delta,
                    phase: TouchPhase::Move,
                    source: MouseWheelSource::Wheel,
                    modifiers,
                };
                self.frame(vec![Event::PointerMoved(at), wheel]);
                self.frame(Vec::new());
                self.hold(Modifiers::NONE);
            }
            Act::Pinch { at, factor } => {
                self.frame(vec![Event::PointerMoved(at), Event::Zoom(factor)]);
            }
            Act::PointerGone => self.frame(vec![Event::PointerGone]),
            Act::Key(modifiers, key) => {
                self.hold(modifiers);
                self.frame(vec![self::key(key, true, modifiers)]);
                self.frame(vec![self::key(key, false, modifiers)]);
                self.hold(Modifiers::NONE);
            }
            Act::Text(text) => self.frame(vec![Event::Text(text)]),
            Act::Paste(text) => self.frame(vec![Event::Paste(text)]),
            Act::Copy => self.frame(vec![Event::Copy]),
            Act::Cut => self.frame(vec![Event::Cut]),
            Act::Focus(focused) => {
                self.focused = focused;
                self.frame(vec![Event::WindowFocused(focused)]);
            }
            Act::Hover(paths) => self.hover(paths),
            Act::Drop(paths) => {
                self.hover(paths.clone());
                self.hovered.clear();
                self.frame_after(0.1, Vec::new(), paths);
            }
            Act::Resize { pixels, scale } => {
                (self.pixels, self.scale) = (pixels, scale);
                self.frame(Vec::new());
                self.frame(Vec::new());
            }
            Act::SystemTheme(theme) => {
                self.system_theme = theme;
                self.frame(Vec::new());
            }
            Act::Entry(_, command) | Act::Send(command) => self.send(*command),
            Act::TypePath(path) => {
                let path = path.display().to_string();
                self.send(DialogCommand::Prompt(PromptCommand::Type(path)));
                self.frame(Vec::new());
            }
            Act::Wait { frames, each_s } => {
                for _ in 0..frames {
                    self.frame_after(each_s, Vec::new(), Vec::new());
                }
            }
            Act::Settle => self.settle(),
            Act::CloseAll | Act::SaveSession | Act::ReopenSaved | Act::Die | Act::Exit => {
                unreachable!("of the window's life")
            }
        }
    }

    fn click(&mut self, at: Pos2, button: PointerButton, modifiers: Modifiers, times: usize) {
        self.hold(modifiers);
        self.frame(vec![Event::PointerMoved(at)]);
        // Several clicks in one frame: with more time between them, they would be single clicks.
        let clicks = (0..times).flat_map(|_| [true, false]);
        let events: Vec<Event> =
            clicks.map(|pressed| pointer(at, button, pressed, modifiers)).collect();
        if times == 1 && self.state().dialogs.prompt.is_none() {
            events.into_iter().for_each(|event| self.frame(vec![event]));
        } else {
            self.frame(events);
        }
        self.hold(Modifiers::NONE);
        self.frame(Vec::new());
    }

    fn drag(
        &mut self,
        [from, to]: [Pos2; 2],
        button: PointerButton,
        modifiers: Modifiers,
        frames: usize,
    ) {
        self.hold(modifiers);
        self.frame(vec![Event::PointerMoved(from)]);
        self.frame(vec![pointer(from, button, true, modifiers)]);
        for frame in 1..=frames {
            let at = from.lerp(to, frame as f32 / frames as f32);
            self.frame(vec![Event::PointerMoved(at)]);
        }
        self.frame(vec![pointer(to, button, false, modifiers)]);
        self.hold(Modifiers::NONE);
        self.frame(Vec::new());
    }

    fn hover(&mut self, paths: Vec<PathBuf>) {
        self.hovered = paths;
        self.frame(Vec::new());
        self.frame(Vec::new());
        self.hovered.clear();
    }

    fn hold(&mut self, modifiers: Modifiers) {
        if self.modifiers != modifiers {
            self.modifiers = modifiers;
            self.frame(vec![Event::ModifiersChanged(modifiers)]);
        }
    }
}

fn pointer(pos: Pos2, button: PointerButton, pressed: bool, modifiers: Modifiers) -> Event {
    Event::PointerButton { pos, button, pressed, modifiers }
}

fn key(key: Key, pressed: bool, modifiers: Modifiers) -> Event {
    Event::Key { key, physical_key: None, pressed, repeat: false, modifiers }
}
