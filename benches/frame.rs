//! Cost of a frame on the window's thread with a million readings. In the scene the camera orbits, the time cursor moves, or the colours
//! change for one frame. In the whole window each plot over time is in front in turn.
//!
//! The time is the thread's processor time on Linux; on other systems it is the wall time. Nothing is drawn: without a GPU the driver would
//! draw on the same processors for a second a frame and empty their caches. `RESECT_DRAW=1` switches drawing on.

use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, SamplingMode, criterion_group, criterion_main};
use eframe::App;
use eframe::egui_wgpu::{RenderState, WgpuSetup};
use egui::{Event, Modifiers, PointerButton, Pos2, RawInput, Rect};
use resect::app::{
    Colouring, Command, Pane, ResectWindow, SceneCommand, SceneView, Start, State, TimeCommand,
    WorkspaceCommand,
};
use resect_core::analysis::Settings;
use resect_core::deployment::Deployment;
use resect_tools::simulation::{Preset, simulate_scenario};

/// Returns a drive long enough for a million readings of the three stations.
fn deployment() -> Arc<Deployment> {
    let mut scenario = Preset::Warthog.scenario();
    let short =
        resect_io::simulation_files::open(&simulate_scenario(&scenario, 1)).expect("simulated");
    scenario.duration_s *= 1e6 / readings(&short) as f64;
    Arc::new(
        resect_io::simulation_files::open(&simulate_scenario(&scenario, 1)).expect("simulated"),
    )
}

fn readings(deployment: &Deployment) -> usize {
    deployment.tracks.iter().map(|track| track.measurements.len()).sum()
}

/// Shows frames and measures their cost.
struct Frames {
    ctx: egui::Context,
    device: wgpu::Device,
    size: egui::Vec2,
    start: Instant,
    time_s: f64,
}

impl Frames {
    fn new(ctx: &egui::Context, device: &wgpu::Device, size: egui::Vec2) -> Self {
        let (ctx, device) = (ctx.clone(), device.clone());
        Self { ctx, device, size, start: Instant::now(), time_s: 0.0 }
    }

    /// Applies events and shows a frame; returns the cost of both, up to the triangles for the GPU.
    fn frame(&mut self, events: Vec<Event>, mut show: impl FnMut(&mut egui::Ui)) -> Duration {
        // As in a window that shows one picture after the other.
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("drawn");
        self.time_s += 1.0 / 60.0;
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, self.size)),
            time: Some(self.time_s),
            events,
            ..Default::default()
        };
        let before = thread_time(self.start);
        let mut output = self.ctx.run_ui(input, &mut show);
        let shapes = std::mem::take(&mut output.shapes);
        black_box(self.ctx.tessellate(shapes, output.pixels_per_point));
        let took = thread_time(self.start) - before;
        // Fonts, which are not drawn here.
        output.textures_delta.clear();
        black_box(output);
        took
    }
}

/// Returns a button pressed or released over the scene.
fn press(pressed: bool) -> Vec<Event> {
    let (pos, modifiers) = (Pos2::new(500.0, 500.0), Modifiers::NONE);
    let button = PointerButton::Primary;
    vec![Event::PointerMoved(pos), Event::PointerButton { pos, button, pressed, modifiers }]
}

/// Returns the pointer moving to and fro, never at rest.
fn drag(i: usize) -> Vec<Event> {
    let x = 500.0 + 200.0 * (0.05 * i as f32).sin();
    vec![Event::PointerMoved(Pos2::new(x, 400.0))]
}

/// Returns the processor time of this thread.
fn thread_time(start: Instant) -> Duration {
    // The kernel updates the count when the thread sleeps.
    std::thread::sleep(Duration::from_micros(1));
    std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split(' ').next()?.parse().ok())
        .map_or_else(|| start.elapsed(), Duration::from_nanos)
}

fn configure<'a>(criterion: &'a mut Criterion, name: &str) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    // A driver that draws may need a second for each frame, which Criterion does not see.
    let draws = std::env::var_os("RESECT_DRAW").is_some();
    let [warm_up_ms, measurement_ms] = if draws { [5, 40] } else { [500, 2000] };
    group.warm_up_time(Duration::from_millis(warm_up_ms));
    group.measurement_time(Duration::from_millis(measurement_ms));
    group
}

/// Continues from one batch to the next: a frame equal to the previous one would cost nothing.
fn bench(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    mut frame: impl FnMut(usize) -> Duration,
) {
    let mut number = 0..;
    group.bench_function(name, |b| {
        b.iter_custom(|frames| number.by_ref().take(frames as usize).map(&mut frame).sum());
    });
}

fn render_state() -> RenderState {
    let mut setup = egui_kittest::wgpu::default_wgpu_setup();
    if std::env::var_os("RESECT_DRAW").is_none()
        && let WgpuSetup::CreateNew(new) = &mut setup
    {
        new.instance_descriptor.backends = wgpu::Backends::NOOP;
        new.instance_descriptor.backend_options.noop.enable = true;
    }
    egui_kittest::wgpu::create_render_state(setup, Default::default())
}

/// Measures the scene in a window of its own.
fn scene(criterion: &mut Criterion) {
    let deployment = deployment();
    eprintln!("{} readings", readings(&deployment));
    let (ctx, render_state) = (egui::Context::default(), render_state());
    let mut state = State::new(ctx.clone());
    state.add(deployment, None);
    state.settle();
    let (_, analysis) = state.analysed().expect("analysed");
    let times_s = analysis.triplets().time_s.clone();
    eprintln!("{} triplets", times_s.len());
    let mut scene = SceneView::new(Some(&render_state));
    let mut frames = Frames::new(&ctx, &render_state.device, egui::Vec2::new(1000.0, 700.0));
    let mut frame = |command: Option<Command>, events: Vec<Event>| {
        let mut commands: Vec<Command> = command.into_iter().collect();
        frames.frame(events, |ui| {
            commands.drain(..).for_each(|command| state.handle(command, ui.ctx()));
            let mut view = std::mem::take(&mut state.scene.view);
            scene.ui(ui, &state, &mut view, &mut commands);
            state.scene.view = view;
        })
    };
    for _ in 0..5 {
        frame(None, Vec::new());
    }
    let mut group = configure(criterion, "scene");
    frame(None, press(true));
    bench(&mut group, "orbit", |i| frame(None, drag(i)));
    frame(None, press(false));
    bench(&mut group, "cursor", |i| {
        frame(
            Some(Command::Time(TimeCommand::MoveCursor(times_s[(i * 37) % times_s.len()]))),
            Vec::new(),
        )
    });
    bench(&mut group, "hover", |i| {
        let at = Pos2::new((i * 7 % 900) as f32 + 50.0, (i * 3 % 600) as f32 + 50.0);
        frame(None, vec![Event::PointerMoved(at)])
    });
    for colouring in [Colouring::Fate, Colouring::Residual, Colouring::Interval] {
        bench(&mut group, &format!("colour-by-{}", colouring.title().to_lowercase()), |i| {
            let other = if i % 2 == 0 { colouring } else { Colouring::Station };
            frame(Some(Command::Scene(SceneCommand::Colour(other))), Vec::new())
        });
    }
    group.finish();
}

/// Measures all panes of the first layout, with each plot over time in front.
fn window(criterion: &mut Criterion) {
    let (ctx, render_state) = (egui::Context::default(), render_state());
    let mut creation = eframe::CreationContext::_new_kittest(ctx.clone());
    creation.wgpu_render_state = Some(render_state.clone());
    let start = Start::Deployments(Vec::new());
    let mut window = ResectWindow::new(&creation, &start, Settings::default());
    window.state.add(deployment(), None);
    window.settle();
    let (_, analysis) = window.state.analysed().expect("analysed");
    let times_s = analysis.triplets().time_s.clone();
    let mut frames = Frames::new(&ctx, &render_state.device, egui::Vec2::new(1600.0, 1000.0));
    let mut eframe = eframe::Frame::_new_kittest();
    let mut frame = |command: Option<Command>, events: Vec<Event>| {
        let mut command = command;
        frames.frame(events, |ui| {
            if let Some(command) = command.take() {
                window.send(command, ui.ctx());
            }
            window.ui(ui, &mut eframe);
        })
    };
    let mut group = configure(criterion, "window");
    for pane in [Pane::Residuals, Pane::Rates, Pane::Intervals, Pane::Channels] {
        for _ in 0..5 {
            frame(Some(Command::Workspace(WorkspaceCommand::ShowPane(pane))), Vec::new());
        }
        let name = format!("{pane:?}").to_lowercase();
        frame(None, press(true));
        bench(&mut group, &format!("orbit-{name}"), |i| frame(None, drag(i)));
        frame(None, press(false));
        bench(&mut group, &format!("cursor-{name}"), |i| {
            frame(
                Some(Command::Time(TimeCommand::MoveCursor(times_s[(i * 37) % times_s.len()]))),
                Vec::new(),
            )
        });
    }
    group.finish();
}

criterion_group!(benches, scene, window);
criterion_main!(benches);
