//! The window: one frame, and opening it.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

mod shell;

use eframe::egui_wgpu::{RenderState, WgpuSetup};

use self::shell::{FIRST_POINTS, LEAST_POINTS, Shell};
use super::actions;
use super::file_dialog::system::SystemDialog;
use super::layout::{Layout, PictureWish};
use super::model::View;
use super::panels;
use super::persist::Folders;
use super::pictures::pane_picture::{self, PanePicture};
use super::saved_state::SavedState;
use super::scene::SceneView;
use super::state::State;
use super::theme;
use crate::app::model::{
    Command, Commands, DeploymentCommand, DialogCommand, Overlay, Pane, PictureOrder,
    WorkspaceCommand,
};
use resect_core::analysis::Settings;
use resect_core::deployment::Deployment;
use resect_io::evaluation_files::EvaluationFiles;
use resect_io::sample::Sample;
use resect_io::source::Source;
use resect_tools::estimates::{EstimatedTrajectory, Options};

/// Interval at which a live deployment is polled for new data.
const LIVE_EVERY: std::time::Duration = std::time::Duration::from_millis(200);

/// Content with which the window opens.
#[derive(Clone)]
pub enum Start {
    Sample(Sample),
    Deployments(Vec<(Arc<Deployment>, Source)>),
    Partly {
        deployments: Vec<(Arc<Deployment>, Source)>,
        /// Trajectories of other systems, evaluated against the last deployment with these options.
        estimates: Vec<(Arc<EstimatedTrajectory>, Options)>,
        /// The reasons of other files that could not be opened.
        why_not: Vec<String>,
    },
    /// The session in this file.
    Session(PathBuf),
    /// Trajectories without a deployment, and the reasons of other files that could not be opened.
    Evaluation(Box<EvaluationFiles>, Vec<String>),
}

/// The state, and the scene on the GPU; the rest is redrawn every frame.
pub struct ResectWindow {
    pub state: State,
    scene: SceneView,
    shell: Shell,
    render_state: Option<RenderState>,
    /// Id of each pane in the window, under which egui remembers its scroll positions.
    scopes: HashMap<Pane, egui::Id>,
    /// Preferences and autosave; `None` for pictures and tests.
    saved_state: Option<(SavedState, egui::Context)>,
}

impl ResectWindow {
    /// Creates a window that saves nothing.
    pub fn new(creation: &eframe::CreationContext<'_>, start: &Start, settings: Settings) -> Self {
        Self::with_saved_state(creation, start, settings, None)
    }

    /// Creates a window that restores saved preferences and sessions, and saves its own.
    pub fn with_saved_state(
        creation: &eframe::CreationContext<'_>,
        start: &Start,
        settings: Settings,
        mut saved_state: Option<SavedState>,
    ) -> Self {
        let ctx = &creation.egui_ctx;
        theme::apply(ctx);
        let mut state = State::new(ctx.clone());
        state.deployments.start_settings = settings;
        // Data that the user asks for by name is not mixed with another window's session.
        let restores = matches!(start, Start::Sample(_));
        let restored = saved_state
            .as_mut()
            .is_some_and(|saved_state| saved_state.begin(ctx, &mut state, restores));
        match start {
            Start::Sample(_) if restored => {}
            Start::Sample(sample) => state.open_placeholder(*sample),
            Start::Session(path) => state.open_session(path.clone()),
            Start::Deployments(deployments) => add_each(&mut state, deployments),
            Start::Partly { deployments, estimates, why_not } => {
                add_each(&mut state, deployments);
                state.evaluate_estimates(estimates.clone());
                why_not.iter().for_each(|line| state.toasts.error(line));
            }
            Start::Evaluation(files, why_not) => {
                state.evaluate_files(EvaluationFiles::clone(files));
                why_not.iter().for_each(|line| state.toasts.error(line));
            }
        }
        let render_state = creation.wgpu_render_state.clone();
        let scene = SceneView::new(render_state.as_ref());
        let saved_state = saved_state.map(|saved_state| (saved_state, ctx.clone()));
        let (shell, scopes) = (Shell::default(), HashMap::new());
        Self { state, scene, shell, render_state, scopes, saved_state }
    }

    pub fn layout(&self) -> &Layout {
        &self.state.workspace.layout
    }

    /// Waits until all jobs have ended; for pictures and tests.
    pub fn settle(&mut self) {
        self.state.settle();
    }

    /// Draws a pane off screen, at its own size and without controls.
    pub fn picture(
        &mut self,
        order: &PictureOrder,
        ctx: &egui::Context,
    ) -> Result<PanePicture, String> {
        let Some(render_state) = &self.render_state else {
            return Err("a picture needs a graphics device: Vulkan, Metal, DX12 or OpenGL".into());
        };
        let scope = self.scopes.get(&order.pane).copied();
        let scope = scope.unwrap_or_else(|| egui::Id::unique("pane without a window"));
        let offscreen = pane_picture::offscreen(render_state);
        let mut scene = SceneView::new(Some(&offscreen));
        let mut view = self.state.scene.view.clone();
        self.state.workspace.picturing = true;
        let state = &self.state;
        let picture = pane_picture::draw_pane(ctx, offscreen, order, scope, |ui| {
            let commands = &mut Commands::new();
            Panes { state, commands, scene: &mut scene, view: &mut view }.pane(order.pane, ui);
        });
        self.state.workspace.picturing = false;
        picture
    }

    /// Executes a command as if a pane had sent it.
    pub fn send(&mut self, command: impl Into<Command>, ctx: &egui::Context) {
        self.state.handle(command, ctx);
    }
}

impl eframe::App for ResectWindow {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        if self.shell.take_unseen() {
            ui.ctx().request_repaint();
            return;
        }
        self.state.take_outcomes();
        self.state.keep_replaced();
        let now_s = ui.input(|input| input.time);
        if self.state.follow_live(now_s) {
            ui.ctx().request_repaint_after(LIVE_EVERY);
        }
        if let Some(next_s) = self.state.advance(now_s) {
            ui.ctx().request_repaint_after_secs((next_s - now_s) as f32);
        }
        let mut commands = Commands::new();
        commands.extend(dropped(ui));
        let ctx = ui.ctx().clone();
        if ctx.input(|input| input.viewport().close_requested())
            && self.state.must_ask_before_closing()
        {
            ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            self.state.dialogs.overlay = Overlay::Closing;
        }
        let is_asking = self.state.dialogs.overlay != Overlay::None
            || self.state.dialogs.prompt.is_some()
            || self.state.asked().is_some();
        self.shell.hide_pointer(&ctx, is_asking);
        if !is_asking {
            actions::from_keys(&ctx, &self.state, &mut commands);
        }
        panels::top_bar::ui(ui, &self.state, &mut commands);
        panels::time_bar::ui(ui, &self.state, &mut commands);
        panels::toasts::ui(ui, &self.state.toasts, self.state.workspace.units, &mut commands);
        let frame = egui::Frame::new().fill(ui.visuals().panel_fill);
        egui::CentralPanel::no_frame().frame(frame).show(ui, |ui| {
            // Panes may change the layout and the camera while they read the rest of the state.
            let mut layout = std::mem::replace(&mut self.state.workspace.layout, Layout::empty());
            let mut view = std::mem::take(&mut self.state.scene.view);
            let mut panes = Panes {
                state: &self.state,
                commands: &mut commands,
                scene: &mut self.scene,
                view: &mut view,
            };
            let wish = layout.ui(ui, &mut |pane, ui| {
                self.scopes.insert(pane, ui.scope_id());
                panes.pane(pane, ui);
            });
            commands.extend(wish.map(|(pane, wish)| match wish {
                PictureWish::Copy => WorkspaceCommand::CopyPicture(pane).into(),
                PictureWish::Choose => DialogCommand::ShowPicture(pane).into(),
            }));
            (self.state.workspace.layout, self.state.scene.view) = (layout, view);
        });
        self.shell.show_pointer(&ctx);
        panels::drop_hint::ui(ui, &self.state, &mut commands);
        dialogs(&ctx, &self.state, &mut commands);
        if let Some((order, to)) = self.state.take_wanted_picture() {
            let picture = self.picture(&order, &ctx);
            self.state.take_picture(&order, to, picture);
        }
        let hovered_s = self.state.time.hover_s.take();
        for command in commands {
            self.send(command, &ctx);
        }
        if self.state.time.playback.playing || self.state.time.hover_s != hovered_s {
            // The other panes also show the time under the pointer.
            ctx.request_repaint();
        }
        if self.state.is_busy() {
            // Repaints to dim the old result, and to animate the spinner.
            ctx.request_repaint_after(std::time::Duration::from_millis(50));
        }
        if let Some(message) = theme::limit_zoom(&ctx) {
            self.state.toasts.done(message);
        }
        self.shell.frame(&ctx, self.state.title());
        if let Some((saved_state, _)) = &mut self.saved_state {
            saved_state.frame(&ctx, &mut self.state);
        }
    }

    /// Background before the first frame, and in the newly exposed area of a growing window.
    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }

    fn on_exit(&mut self) {
        self.state.finish();
        if let Some((saved_state, ctx)) = self.saved_state.take() {
            saved_state.finish(&ctx, &self.state);
        }
    }
}

/// Opens the files that were dropped in this frame.
fn dropped(ui: &egui::Ui) -> Option<Command> {
    let paths = ui.input(|input| {
        input.raw.dropped_files.iter().map(|file| file.path().to_owned()).collect::<Vec<_>>()
    });
    (!paths.is_empty()).then(|| DeploymentCommand::OpenPaths(paths).into())
}

/// Draws the sheets and the dialogs above the panes.
fn dialogs(ctx: &egui::Context, state: &State, commands: &mut Commands) {
    match &state.dialogs.overlay {
        Overlay::None => {}
        Overlay::Palette(palette) => {
            panels::command_palette::ui(ctx, state, palette, commands);
        }
        Overlay::Shortcuts => panels::shortcuts::ui(ctx, state, commands),
        Overlay::Glossary(lookup) => panels::glossary::ui(ctx, lookup, commands),
        Overlay::Licences(lines) => panels::licences::ui(ctx, lines, commands),
        Overlay::Picture(order) => panels::picture::ui(ctx, state, order, commands),
        Overlay::Closing => panels::closing::ui(ctx, state, commands),
    }
    if let Some(prompt) = &state.dialogs.prompt {
        panels::path_prompt::ui(ctx, &prompt.shown, commands);
    }
    if let Some(asked) = state.asked() {
        panels::asked::ui(ctx, asked, commands);
    }
}

/// Data from which the panes are drawn.
struct Panes<'a> {
    state: &'a State,
    commands: &'a mut Commands,
    scene: &'a mut SceneView,
    view: &'a mut View,
}

impl Panes<'_> {
    fn pane(&mut self, pane: Pane, ui: &mut egui::Ui) {
        use super::plots;
        match pane {
            Pane::Deployment => panels::deployment::ui(ui, self.state, self.commands),
            Pane::Pipeline => panels::pipeline::ui(ui, self.state, self.commands),
            Pane::Scene
                if self.state.deployments.open.is_empty()
                    && self.state.deployments.opening.is_empty() =>
            {
                panels::empty_state::ui(ui, &self.state.session, self.commands);
            }
            Pane::Scene => self.scene.ui(ui, self.state, self.view, self.commands),
            Pane::Result => panels::result::ui(ui, self.state, self.commands),
            Pane::Findings => panels::findings::ui(ui, self.state, self.commands),
            Pane::Residuals => plots::residuals::ui(ui, self.state, self.commands),
            Pane::Rates => plots::rates::ui(ui, self.state, self.commands),
            Pane::Clocks => plots::clocks::ui(ui, self.state, self.commands),
            Pane::Channels => plots::channels::ui(ui, self.state, self.commands),
            Pane::Intervals => plots::intervals::ui(ui, self.state, self.commands),
            Pane::Histogram => plots::histogram::ui(ui, self.state),
            Pane::PriorSearch => plots::prior_search::ui(ui, self.state, self.commands),
            Pane::SideBySide => panels::side_by_side::ui(ui, self.state, self.commands),
            Pane::Studies => panels::studies::ui(ui, self.state, self.commands),
            Pane::Reading => panels::reading::ui(ui, self.state, self.commands),
            Pane::Runs => panels::runs::ui(ui, self.state, self.commands),
            Pane::Guide => panels::guide::ui(ui, self.state, self.commands),
            Pane::ControlPoints => panels::control_points::ui(ui, self.state, self.commands),
            Pane::Solver => panels::solver::ui(ui, self.state),
            Pane::Evaluation => panels::evaluation::ui(ui, self.state, self.commands),
            Pane::PlanNumbers => panels::plan::numbers(ui, self.state, self.commands),
            Pane::PlanMap => plots::plan_map::ui(ui, self.state, self.commands),
            Pane::Prediction => panels::plan::foreseen(ui, self.state, self.commands),
            Pane::Live => panels::live::ui(ui, self.state, self.commands),
        }
    }
}

fn add_each(state: &mut State, deployments: &[(Arc<Deployment>, Source)]) {
    state.workspace.layout.bring_forward(Pane::Result);
    for (deployment, source) in deployments {
        state.add(Arc::clone(deployment), Some(source.clone()));
    }
}

/// Opens the window and returns when it is closed.
pub fn open_window(start: Start) -> eframe::Result {
    let icon = image::load_from_memory(include_bytes!("../../assets/icon.png")).ok().map(|icon| {
        let icon = icon.to_rgba8();
        egui::IconData { width: icon.width(), height: icon.height(), rgba: icon.into_raw() }
    });
    let saved_state = Folders::of_user().map(|folders| SavedState::start(&folders));
    let preferences = saved_state.as_ref().map(SavedState::preferences);
    let size = preferences.and_then(|preferences| preferences.window_points);
    let mut viewport = egui::ViewportBuilder::default()
        .with_title("resect")
        .with_app_id("resect")
        .with_inner_size(size.unwrap_or(FIRST_POINTS))
        .with_maximized(preferences.is_some_and(|preferences| preferences.maximized))
        .with_min_inner_size(LEAST_POINTS)
        .with_drag_and_drop(true);
    if let Some(icon) = icon {
        viewport = viewport.with_icon(icon);
    }
    // No gradients are drawn, so dithering would have no effect.
    let mut options = eframe::NativeOptions { viewport, dithering: false, ..Default::default() };
    #[cfg(target_os = "linux")]
    super::display_server::choose(&mut options);
    // Keeping this instance avoids loading the drivers twice.
    let _probe = match &mut options.wgpu_options.wgpu_setup {
        WgpuSetup::CreateNew(setup) => {
            if cfg!(windows) {
                let describe = Arc::clone(&setup.device_descriptor);
                setup.native_adapter_selector = Some(Arc::new(move |adapters, surface| {
                    usable_adapter(adapters, surface, |adapter| describe(adapter))
                }));
            }
            Some(leave_opengl_out(&mut setup.instance_descriptor.backends))
        }
        WgpuSetup::Existing(_) => None,
    };
    eframe::run_native(
        "resect",
        options,
        Box::new(move |creation| {
            let mut window =
                ResectWindow::with_saved_state(creation, &start, Settings::default(), saved_state);
            window.shell = Shell::of_system();
            window.state.dialogs.system = SystemDialog::of_system();
            Ok(Box::new(window))
        }),
    )
}

/// Returns the fastest adapter that opens a device. Windows has two interfaces to each graphics card, and one may refuse: under Wine,
/// Direct3D 12 loses its device at once, where Vulkan draws.
fn usable_adapter(
    adapters: &[wgpu::Adapter],
    surface: Option<&wgpu::Surface<'_>>,
    describe: impl Fn(&wgpu::Adapter) -> wgpu::DeviceDescriptor<'static>,
) -> Result<wgpu::Adapter, String> {
    let draws_on = |adapter: &&wgpu::Adapter| {
        surface.is_none_or(|surface| adapter.is_surface_supported(surface))
    };
    let mut adapters: Vec<_> = adapters.iter().filter(draws_on).collect();
    adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    let mut why = "no adapter draws on a window".to_owned();
    for adapter in adapters {
        match pollster::block_on(adapter.request_device(&describe(adapter))) {
            Ok(_) => return Ok(adapter.clone()),
            Err(error) => why = error.to_string(),
        }
    }
    Err(why)
}

/// Excludes OpenGL if a better backend is available: its initialisation is a fifth of the time to the first frame.
fn leave_opengl_out(backends: &mut wgpu::Backends) -> wgpu::Instance {
    let better = *backends & wgpu::Backends::PRIMARY;
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = better;
    let instance = wgpu::Instance::new(descriptor);
    if !pollster::block_on(instance.enumerate_adapters(better)).is_empty() {
        *backends = better;
    }
    instance
}
