//! Size and title of the system's window.

use egui::{PointerState, Vec2, ViewportCommand};

/// Default and least size of the window (points).
pub const FIRST_POINTS: [f32; 2] = [1600.0, 1000.0];
pub const LEAST_POINTS: [f32; 2] = [480.0, 300.0];
/// Size of the system's bars and of the window's edges (points).
const BARS: Vec2 = Vec2::new(16.0, 96.0);

/// Properties that the system already has.
#[derive(Default)]
pub struct Shell {
    title: String,
    fitted: bool,
    /// True until the first frame, which is drawn before the system shows the window.
    unseen: bool,
    /// Frame in which the open dialog opened; `None` without a dialog.
    asking_since: Option<u64>,
    /// The real pointer, while the panes are drawn without one.
    pointer: Option<PointerState>,
}

impl Shell {
    /// Creates the shell of a window that the system shows after its first frame, as eframe does.
    pub fn of_system() -> Self {
        Self { unseen: true, ..Self::default() }
    }

    /// Returns true if nobody will see this frame. Without a graphics card, a frame takes a tenth of a second.
    pub fn take_unseen(&mut self) -> bool {
        std::mem::take(&mut self.unseen)
    }

    /// Hides the pointer from the panes while a dialog opens, which takes several passes. egui shows a tooltip as long as the pointer rests
    /// on its widget, and the tooltip would cover a dialog opened by a key.
    pub fn hide_pointer(&mut self, ctx: &egui::Context, is_asking: bool) {
        let now = ctx.cumulative_frame_nr();
        let since = self.asking_since.filter(|_| is_asking).unwrap_or(now);
        self.asking_since = is_asking.then_some(since);
        if is_asking && now <= since + 1 {
            self.pointer = Some(ctx.input_mut(|input| std::mem::take(&mut input.pointer)));
        }
    }

    /// Restores the hidden pointer, for the dialogs.
    pub fn show_pointer(&mut self, ctx: &egui::Context) {
        if let Some(pointer) = self.pointer.take() {
            ctx.input_mut(|input| input.pointer = pointer);
        }
    }

    /// Sends changed properties to the system.
    pub fn frame(&mut self, ctx: &egui::Context, title: String) {
        if title != self.title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
        // Runs once, when the screen is known: later the size is the user's.
        let sizes = ctx.input(|input| {
            let viewport = input.viewport();
            Some((viewport.inner_rect?.size(), viewport.monitor_size?))
        });
        if let Some((inner, screen)) = sizes.filter(|_| !self.fitted) {
            self.fitted = true;
            if let Some(size) = fitting(inner, screen) {
                ctx.send_viewport_cmd(ViewportCommand::InnerSize(size));
                // The system knows the size of its bars best.
                ctx.send_viewport_cmd(ViewportCommand::Maximized(true));
            }
        }
    }
}

/// Returns the largest size that fits on a screen; `None` if the wanted size fits.
fn fitting(wanted: Vec2, screen: Vec2) -> Option<Vec2> {
    // Some systems report a degenerate size for an unknown screen.
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
