//! A window without a screen, and simulated actions of a user.
//!
//! Reference pictures are in `screenshots/`; Mesa's software Vulkan is the one rasteriser. After an intended change run
//! `UPDATE_SNAPSHOTS=1 cargo test --test window` and check the new pictures before committing them.

use egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, Theme, Vec2};
use egui_kittest::kittest::Queryable;
use egui_kittest::{Harness, SnapshotOptions, image_snapshot_options};
use resect::app::saved_state::SavedState;
use resect::app::{
    Command, DeploymentCommand, OpenDeployment, Pane, ResectWindow, Start, offscreen_renderer,
};
use resect_core::analysis::Settings;
use resect_core::deployment::Deployment;
use resect_io::sample::Sample;

pub const LARGE: Vec2 = Vec2::new(1600.0, 1000.0);
pub const SMALL: Vec2 = Vec2::new(1100.0, 700.0);

pub type Window = Harness<'static, ResectWindow>;

/// Returns the window with the calibrated Warthog sample. It has its own prompt for paths.
pub fn window(size: Vec2, theme: Theme) -> Window {
    window_from(size, theme, &Start::Sample(Sample::Warthog), None)
}

/// Returns the window as the program starts it, with or without saving of the session.
pub fn window_from(
    size: Vec2,
    theme: Theme,
    start: &Start,
    saved_state: Option<SavedState>,
) -> Window {
    let start = start.clone();
    let mut harness = Harness::builder()
        .with_size(size)
        .with_theme(theme)
        .with_render_cursor(false)
        .renderer(offscreen_renderer().expect("Mesa is installed by tests/run"))
        .build_eframe(move |creation| {
            ResectWindow::with_saved_state(creation, &start, Settings::default(), saved_state)
        });
    harness.state_mut().state.workspace.fixed_elapsed_ms = Some(1.0);
    settle(&mut harness);
    harness
}

/// Runs frames until the worker has processed the commands and the panes show its results.
pub fn settle(harness: &mut Window) {
    for _ in 0..2 {
        harness.run_steps(2);
        harness.state_mut().settle();
    }
    harness.run_steps(3);
}

/// Executes a command as a pane would.
pub fn send(harness: &mut Window, command: impl Into<Command>) {
    let ctx = harness.ctx.clone();
    harness.state_mut().send(command, &ctx);
    settle(harness);
}

/// Changes settings of the active deployment as a pane would.
pub fn set(harness: &mut Window, change: impl FnOnce(&mut Settings)) {
    let mut settings = settings(harness);
    change(&mut settings);
    send(harness, DeploymentCommand::Set(settings));
}

pub fn open(harness: &mut Window, deployment: Deployment) {
    harness.state_mut().state.add(deployment.into(), None);
    settle(harness);
}

pub fn click(harness: &mut Window, name: &str) {
    harness.get_by_label(name).click();
    settle(harness);
}

pub fn double_click(harness: &mut Window, pos: Pos2) {
    harness.hover_at(pos);
    harness.run_steps(1);
    // In one frame: the harness lets too much time pass between frames for a double click.
    let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
    let press = |pressed| Event::PointerButton { pos, button, pressed, modifiers };
    harness.input_mut().events.extend([true, false, true, false].map(press));
    settle(harness);
}

pub fn press(harness: &mut Window, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    settle(harness);
}

/// Replaces the text in the focused text field, and presses Enter, all in one
/// frame: the harness gives every event a frame of its own, slow machines do not.
pub fn type_and_enter_at_once(harness: &mut Window, text: &str) {
    let key = |key, modifiers| Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers,
    };
    harness.input_mut().events.extend([
        key(Key::A, Modifiers::COMMAND),
        Event::Text(text.to_owned()),
        key(Key::Enter, Modifiers::NONE),
    ]);
    settle(harness);
}

pub fn settings(harness: &Window) -> Settings {
    *harness.state().state.settings()
}

pub fn shown(harness: &Window) -> &OpenDeployment {
    harness.state().state.active().expect("open")
}

pub fn triplets(harness: &Window) -> usize {
    harness.state().state.analysed().map_or(0, |(_, a)| a.pipeline.triplets.len())
}

/// Region of a snapshot: changes elsewhere do not affect it, and the repository stays small.
#[derive(Clone, Copy)]
pub enum Part {
    Window,
    Pane(Pane),
    /// A dialog, with this maximum size.
    Middle(Vec2),
    /// Toasts: as wide as the window, with this height.
    Bottom(f32),
}

/// Compares the window with its reference picture in `screenshots/`.
#[track_caller]
pub fn snapshot(harness: &mut Window, name: &str) {
    snapshot_of(harness, Part::Window, name);
}

/// Compares a region of the window.
#[track_caller]
pub fn snapshot_of(harness: &mut Window, part: Part, name: &str) {
    // Away from every widget with a hover effect.
    harness.hover_at(Pos2::new(700.0, 4.0));
    harness.run_steps(2);
    // A few pixels on the edge of a disc may differ with another version of Mesa.
    let options = SnapshotOptions::new().output_path("screenshots").max_failed_pixels(60);
    let picture = harness.render().expect("a picture");
    let whole = Rect::from_min_size(Pos2::ZERO, harness.ctx.content_rect().size());
    let place = match part {
        Part::Window => whole,
        Part::Pane(pane) => harness.state().layout().place(pane).expect("in the window"),
        Part::Middle(size) => Rect::from_center_size(whole.center(), size),
        Part::Bottom(height) => whole.with_min_y(whole.max.y - height),
    };
    let [left, top, right, bottom] = {
        let place = place.intersect(whole);
        [place.left(), place.top(), place.right(), place.bottom()].map(|side| side.round() as u32)
    };
    let picture =
        image::imageops::crop_imm(&picture, left, top, right - left, bottom - top).to_image();
    // At once, and not when the harness is dropped: a test may have several snapshots.
    image_snapshot_options(&picture, name, &options);
}
