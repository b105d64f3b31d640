//! A window without a screen: frames as the system would request them, and the checks of every frame.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use eframe::App;
use eframe::egui_wgpu::{RenderState, Renderer, RendererOptions};
use egui::{
    Event, HoveredFile, Modifiers, Pos2, RawInput, Rect, Theme, Vec2, ViewportCommand, ViewportId,
};
use resect::app::file_dialog::PromptCommand;
use resect::app::persist::Folders;
use resect::app::saved_state::SavedState;
use resect::app::{Command, DialogCommand, ResectWindow, Start, State};
use resect_core::analysis::Settings;
use resect_io::sample::Sample;

use crate::process::thread_time;

/// Longest time of a frame on the window's thread. Without optimisation it only detects a hang.
const LONGEST_FRAME: Duration =
    Duration::from_millis(if cfg!(debug_assertions) { 5000 } else { 100 });

pub fn gpu() -> RenderState {
    let setup = egui_kittest::wgpu::default_wgpu_setup();
    egui_kittest::wgpu::create_render_state(setup, RendererOptions::PREDICTABLE)
}

/// A file as the window system passes it.
#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

pub struct Screen {
    gpu: RenderState,
    /// Folder of all the files that the window reads and writes.
    folder: PathBuf,
    ctx: egui::Context,
    window: Option<ResectWindow>,
    eframe: eframe::Frame,
    pub pixels: [u32; 2],
    pub scale: f32,
    pub system_theme: Theme,
    pub modifiers: Modifiers,
    pub focused: bool,
    pub hovered: Vec<PathBuf>,
    time_s: f64,
    pub slowest: Duration,
}

impl Screen {
    pub fn new(gpu: &RenderState, folder: &Path) -> Self {
        let mut screen = Self {
            gpu: gpu.clone(),
            folder: folder.to_owned(),
            ctx: egui::Context::default(),
            window: None,
            eframe: eframe::Frame::_new_kittest(),
            pixels: [1280, 800],
            scale: 1.0,
            system_theme: Theme::Dark,
            modifiers: Modifiers::NONE,
            focused: true,
            hovered: Vec::new(),
            time_s: 0.0,
            slowest: Duration::ZERO,
        };
        screen.start();
        screen
    }

    /// Opens a window as `resect` does without a path.
    pub fn start(&mut self) {
        assert!(self.window.is_none(), "one at a time");
        // Each window registers its picture of the scene with a renderer, which would keep all of them.
        let renderer =
            Renderer::new(&self.gpu.device, self.gpu.target_format, RendererOptions::PREDICTABLE);
        let renderer = Arc::new(egui::mutex::RwLock::new(renderer));
        self.ctx = egui::Context::default();
        let mut creation = eframe::CreationContext::_new_kittest(self.ctx.clone());
        creation.wgpu_render_state = Some(RenderState { renderer, ..self.gpu.clone() });
        let keeping = SavedState::start(&Folders::inside(&self.folder.join("config")));
        // Saves in every frame, so that the state of the last frame is saved.
        let keeping = keeping.every(Duration::ZERO);
        let start = Start::Sample(Sample::Warthog);
        let window =
            ResectWindow::with_saved_state(&creation, &start, Settings::default(), Some(keeping));
        self.window = Some(window);
        self.frame(Vec::new());
    }

    pub fn window(&mut self) -> &mut ResectWindow {
        self.window.as_mut().expect("open")
    }

    pub fn state(&self) -> &State {
        &self.window.as_ref().expect("open").state
    }

    pub fn ctx(&self) -> &egui::Context {
        &self.ctx
    }

    /// Removes the window without notice, as by a crash.
    pub fn die(&mut self) {
        self.window = None;
    }

    pub fn exit(&mut self) {
        self.window().on_exit();
        self.window = None;
    }

    /// Returns the window's size by the system (points).
    pub fn size(&self) -> Vec2 {
        let pixels = Vec2::new(self.pixels[0] as f32, self.pixels[1] as f32);
        pixels / (self.scale * self.ctx.zoom_factor())
    }

    pub fn send(&mut self, command: impl Into<Command>) {
        let ctx = self.ctx.clone();
        self.window().send(command, &ctx);
        self.stay_inside();
        self.frame(Vec::new());
    }

    pub fn settle(&mut self) {
        for _ in 0..2 {
            self.window().settle();
            self.frame(Vec::new());
        }
        self.window().settle();
        // A scroll continues for some frames, and moves the widgets under the pointer.
        while self.ctx.input(|input| input.smooth_scroll_delta() != Vec2::ZERO) {
            self.frame(Vec::new());
        }
    }

    pub fn frame(&mut self, events: Vec<Event>) {
        self.frame_after(1.0 / 60.0, events, Vec::new());
    }

    /// Shows a frame at a time after the previous one (s).
    pub fn frame_after(&mut self, seconds: f64, events: Vec<Event>, dropped: Vec<PathBuf>) {
        self.time_s += seconds;
        let size = self.size();
        let rect = Rect::from_min_size(Pos2::ZERO, size);
        let mut input = RawInput {
            screen_rect: Some(rect),
            max_texture_side: Some(self.gpu.device.limits().max_texture_dimension_2d as usize),
            time: Some(self.time_s),
            focused: self.focused,
            system_theme: Some(self.system_theme),
            hovered_files: self.hovered.iter().map(|path| hovered(path)).collect(),
            dropped_files: dropped.into_iter().map(|path| Arc::new(Dropped(path)) as _).collect(),
            events,
            ..RawInput::default()
        };
        if let Some(viewport) = input.viewports.get_mut(&ViewportId::ROOT) {
            viewport.native_pixels_per_point = Some(self.scale);
            viewport.inner_rect = Some(rect);
            viewport.focused = Some(self.focused);
        }
        let (ctx, eframe) = (&self.ctx, &mut self.eframe);
        let window = self.window.as_mut().expect("open");
        let before = thread_time();
        let mut output = ctx.run_ui(input, |ui| window.ui(ui, eframe));
        let shapes = std::mem::take(&mut output.shapes);
        std::hint::black_box(ctx.tessellate(shapes, output.pixels_per_point));
        let took = thread_time() - before;
        // Fonts, which are not drawn here.
        output.textures_delta.clear();
        for command in output.viewport_output.into_values().flat_map(|it| it.commands) {
            if let ViewportCommand::Screenshot(callback) = command {
                let pixels = self.pixels.map(|side| side as usize);
                callback.complete(egui::ColorImage::filled(pixels, egui::Color32::GRAY).into());
            }
        }
        self.gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("drawn");
        self.stay_inside();
        self.slowest = self.slowest.max(took);
        assert!(took <= LONGEST_FRAME, "a frame took the window's thread {took:.1?}");
    }

    /// Redirects a prompt for another folder to the monkey's own, before it can be answered.
    fn stay_inside(&mut self) {
        let inside = |path: &Path| path.starts_with(&self.folder);
        let Some(prompt) = self.state().dialogs.prompt.as_ref().map(|prompt| &prompt.shown) else {
            return;
        };
        let text = &prompt.text;
        let relative = !text.starts_with(['/', '\\', '~']);
        let harmless = !text.contains("..") && (relative || inside(Path::new(text)));
        let others = prompt.overwrite.as_deref().is_none_or(inside);
        if !(inside(prompt.folder()) && harmless && others) {
            let home = PromptCommand::GoTo(self.folder.join("data"));
            let ctx = self.ctx.clone();
            for command in [PromptCommand::KeepFile, home] {
                self.window().send(DialogCommand::Prompt(command), &ctx);
            }
        }
    }
}

fn hovered(path: &Path) -> HoveredFile {
    HoveredFile { path: Some(path.to_owned()), ..HoveredFile::default() }
}
