//! The window among those of the system: how large it opens, and what its title says.

use egui::{PointerState, Vec2, ViewportCommand};

/// How large the window opens where nobody chose a size, and how small it may be made (points).
pub const FIRST_POINTS: [f32; 2] = [1600.0, 1000.0];
pub const LEAST_POINTS: [f32; 2] = [480.0, 300.0];
/// What the bars of the system and the window's own edges take of a screen (points).
const BARS: Vec2 = Vec2::new(16.0, 96.0);

/// What the system was told of the window.
#[derive(Default)]
pub struct Shell {
    title: String,
    fitted: bool,
    /// The next frame is drawn before the system shows the window.
    unseen: bool,
    /// The frame in which a dialog opened that is open.
    asking_since: Option<u64>,
    /// The pointer, while the panes are drawn as if there were none.
    pointer: Option<PointerState>,
}

impl Shell {
    /// Makes the shell of a window that the system shows after its first frame, as eframe does.
    pub fn of_system() -> Self {
        Self { unseen: true, ..Self::default() }
    }

    /// Whether nobody will see this frame: without a graphics card, one takes a tenth of a second.
    pub fn take_unseen(&mut self) -> bool {
        std::mem::take(&mut self.unseen)
    }

    /// Has the panes drawn as if there were no pointer while a dialog opens, which takes several passes: egui keeps a tooltip for as long as the
    /// pointer rests on what it is about, and it would lie over a dialog that a key opened.
    pub fn hide_pointer(&mut self, ctx: &egui::Context, is_asking: bool) {
        let now = ctx.cumulative_frame_nr();
        let since = self.asking_since.filter(|_| is_asking).unwrap_or(now);
        self.asking_since = is_asking.then_some(since);
        if is_asking && now <= since + 1 {
            self.pointer = Some(ctx.input_mut(|input| std::mem::take(&mut input.pointer)));
        }
    }

    /// Gives back the pointer that was hidden, for the dialogs.
    pub fn show_pointer(&mut self, ctx: &egui::Context) {
        if let Some(pointer) = self.pointer.take() {
            ctx.input_mut(|input| input.pointer = pointer);
        }
    }

    /// Tells the system what is another than before.
    pub fn frame(&mut self, ctx: &egui::Context, title: String) {
        if title != self.title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
        // Once, when the screen is known: later the size is the user's.
        let sizes = ctx.input(|input| {
            let viewport = input.viewport();
            Some((viewport.inner_rect?.size(), viewport.monitor_size?))
        });
        if let Some((inner, screen)) = sizes.filter(|_| !self.fitted) {
            self.fitted = true;
            if let Some(size) = fitting(inner, screen) {
                ctx.send_viewport_cmd(ViewportCommand::InnerSize(size));
                // The system knows best where its bars are.
                ctx.send_viewport_cmd(ViewportCommand::Maximized(true));
            }
        }
    }
}

/// The size that a window gets on a screen that has no room for the one it wants; `None` where it has.
fn fitting(wanted: Vec2, screen: Vec2) -> Option<Vec2> {
    // What some systems say of a screen that they do not know.
    let is_screen = screen.min_elem() > 1.0;
    let room = (screen - BARS).max(Vec2::from(LEAST_POINTS).min(screen));
    (is_screen && (wanted.x > room.x || wanted.y > room.y)).then(|| wanted.min(room))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_window_fits_its_screen() {
        let first = Vec2::from(FIRST_POINTS);
        assert_eq!(fitting(first, Vec2::new(1920.0, 1200.0)), None);
        for screen in [[1366.0, 768.0], [1280.0, 720.0], [683.0, 384.0], [400.0, 240.0]] {
            let screen = Vec2::from(screen);
            let size = fitting(first, screen).expect("too large");
            assert!(size.x <= screen.x && size.y <= screen.y && size.min_elem() > 200.0, "{size}");
        }
        assert_eq!(fitting(Vec2::new(1000.0, 600.0), Vec2::new(1280.0, 720.0)), None);
        assert_eq!(fitting(first, Vec2::ZERO), None);
    }
}
