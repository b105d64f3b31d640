//! The monkey's acts.

use std::path::PathBuf;

use egui::{Key, Modifiers, PointerButton, Pos2, Theme, Vec2};
use resect::app::Command;

#[derive(Clone, Debug)]
pub enum Act {
    Move(Pos2),
    /// Button pressed and released a number of times.
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
    /// The window loses the focus, or gets it back.
    Focus(bool),
    Hover(Vec<PathBuf>),
    Drop(Vec<PathBuf>),
    Resize {
        pixels: [u32; 2],
        scale: f32,
    },
    SystemTheme(Theme),
    /// A menu entry, by its name.
    Entry(#[expect(dead_code, reason = "for who reads what was done")] String, Box<Command>),
    /// A command that a pane may send.
    Send(Box<Command>),
    /// Text in the prompt for a path, in one event; Enter is a separate key.
    TypePath(PathBuf),
    /// Frames pass, and time of the window's clock.
    Wait {
        frames: usize,
        each_s: f64,
    },
    /// Waits until all background work is done.
    Settle,
    CloseAll,
    SaveSession,
    /// Opens the session that was saved last.
    ReopenSaved,
    /// The window crashes and another one restores its session.
    Die,
    /// The window is closed, opened again and asked to reopen its session.
    Exit,
}
