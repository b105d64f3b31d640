//! What the monkey can do.

use std::path::PathBuf;

use egui::{Key, Modifiers, PointerButton, Pos2, Theme, Vec2};
use resect::app::Command;

#[derive(Clone, Debug)]
pub enum Act {
    Move(Pos2),
    /// Pressed and released so many times.
    Click {
        at: Pos2,
        button: PointerButton,
        modifiers: Modifiers,
        times: usize,
    },
    Drag {
        from: Pos2,
        to: Pos2,
        button: PointerButton,
        modifiers: Modifiers,
        frames: usize,
    },
    Wheel {
        at: Pos2,
        delta: Vec2,
        modifiers: Modifiers,
    },
    Pinch {
        at: Pos2,
        factor: f32,
    },
    PointerGone,
    Key(Modifiers, Key),
    Text(String),
    Paste(String),
    Copy,
    Cut,
    /// The window is behind another, or in front again.
    Focus(bool),
    Hover(Vec<PathBuf>),
    Drop(Vec<PathBuf>),
    Resize {
        pixels: [u32; 2],
        scale: f32,
    },
    SystemTheme(Theme),
    /// An entry of the menus, by its name.
    Entry(#[expect(dead_code, reason = "for who reads what was done")] String, Box<Command>),
    /// What a pane may send.
    Send(Box<Command>),
    /// In the prompt for a path, in one go; Enter comes as a key.
    TypePath(PathBuf),
    /// Frames pass, and time of the window's clock.
    Wait {
        frames: usize,
        each_s: f64,
    },
    /// Nothing is under way any more.
    Settle,
    CloseAll,
    SaveSession,
    /// Opens the session that was saved last.
    ReopenSaved,
    /// The window dies and another restores what it had open.
    Die,
    /// The window is closed, opened again and told to reopen what was open.
    Exit,
}
