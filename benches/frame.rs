//! What a frame costs the window's thread with a million readings: the scene while the camera orbits, while the time
//! cursor moves and in the one frame in which colours change, and the whole window with each plot over time in front.
//!
//! The time is what the thread spent on a processor, as Linux counts it; elsewhere it is the clock's. Without a GPU
//! the driver draws on the same processors in threads of its own, for a second and more: that is not the scene's cost.

use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

use criterion::{Criterion, SamplingMode, criterion_group, criterion_main};
use eframe::egui::{self, Event, Modifiers, PointerButton, Pos2, RawInput, Rect};
use eframe::egui_wgpu::wgpu;
use resect::analysis::Settings;
use resect::app::{
    Colouring, Command, Pane, ResectWindow, SceneView, Start, State, offscreen_renderer,
};
use resect::deployment::Deployment;
use resect::simulation::{Preset, simulate_scenario};

const SIZE: egui::Vec2 = egui::Vec2::new(1000.0, 700.0);

/// A drive so long that the three stations read a million times.
fn deployment() -> Arc<Deployment> {
    let mut scenario = Preset::Warthog.scenario();
    let short = simulate_scenario(&scenario, 1).deployment().expect("simulated");
    scenario.duration_s *= 1e6 / readings(&short) as f64;
    Arc::new(simulate_scenario(&scenario, 1).deployment().expect("simulated"))
}

fn readings(deployment: &Deployment) -> usize {
    deployment.tracks.iter().map(|track| track.measurements.len()).sum()
}

/// The scene in a window of its own.
struct Window {
    ctx: egui::Context,
    state: State,
    scene: SceneView,
    device: wgpu::Device,
    start: Instant,
    time_s: f64,
}

impl Window {
    fn new(deployment: Arc<Deployment>) -> Self {
        let ctx = egui::Context::default();
        let mut state = State::new(ctx.clone());
        state.add(deployment, None);
        state.settle();
        let setup = egui_kittest::wgpu::default_wgpu_setup();
        let render_state = egui_kittest::wgpu::create_render_state(setup, Default::default());
        let scene = SceneView::new(Some(&render_state));
        let device = render_state.device;
        let mut window = Self { ctx, state, scene, time_s: 0.0, device, start: Instant::now() };
        for _ in 0..5 {
            window.frame(None, Vec::new());
        }
        window
    }

    /// Carries out a command and shows a frame; gives what both cost.
    fn frame(&mut self, command: Option<Command>, events: Vec<Event>) -> Duration {
        // As a window does that shows one picture after the other.
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("drawn");
        self.time_s += 1.0 / 60.0;
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, SIZE)),
            time: Some(self.time_s),
            events,
            ..Default::default()
        };
        let before = thread_time(self.start);
        if let Some(command) = command {
            self.state.handle(command, &self.ctx);
        }
        let (state, scene) = (&self.state, &mut self.scene);
        let mut commands = Vec::new();
        let mut output = self.ctx.run_ui(input, |ui| scene.ui(ui, state, &mut commands));
        for command in commands {
            self.state.handle(command, &self.ctx);
        }
        let took = thread_time(self.start) - before;
        // Fonts, which nobody draws here.
        output.textures_delta.clear();
        black_box(output);
        took
    }

    fn press(&mut self, pressed: bool) {
        let (pos, modifiers) = (Pos2::new(500.0, 600.0), Modifiers::NONE);
        let button = PointerButton::Primary;
        let press = Event::PointerButton { pos, button, pressed, modifiers };
        self.frame(None, vec![Event::PointerMoved(pos), press]);
    }
}

/// What this thread has spent on a processor.
fn thread_time(start: Instant) -> Duration {
    // The count is brought up to date when the thread rests.
    std::thread::sleep(Duration::from_micros(1));
    std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split(' ').next()?.parse().ok())
        .map_or_else(|| start.elapsed(), Duration::from_nanos)
}

fn scene(criterion: &mut Criterion) {
    let deployment = deployment();
    eprintln!("{} readings", readings(&deployment));
    let mut window = Window::new(deployment);
    let (_, analysis) = window.state.analysed().expect("analysed");
    let times_s = analysis.triplets().time_s.clone();
    eprintln!("{} triplets", times_s.len());
    let mut group = criterion.benchmark_group("scene");
    // Few frames: Criterion does not see that the driver may need a second for each.
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    group.warm_up_time(Duration::from_millis(5)).measurement_time(Duration::from_millis(40));
    let mut bench = |name: &str, frame: &mut dyn FnMut(usize) -> Duration| {
        // Goes on from one batch to the next: a frame like the one before it would cost nothing.
        let mut number = 0..;
        group.bench_function(name, |b| {
            b.iter_custom(|frames| number.by_ref().take(frames as usize).map(&mut *frame).sum());
        });
    };

    window.press(true);
    bench("orbit", &mut |i| {
        // To and fro, and never a rest.
        let x = 500.0 + 200.0 * (0.05 * i as f32).sin();
        window.frame(None, vec![Event::PointerMoved(Pos2::new(x, 500.0))])
    });
    window.press(false);
    bench("cursor", &mut |i| {
        let time_s = times_s[(i * 37) % times_s.len()];
        window.frame(Some(Command::MoveCursor(time_s)), Vec::new())
    });
    bench("hover", &mut |i| {
        let at = Pos2::new((i * 7 % 900) as f32 + 50.0, (i * 3 % 600) as f32 + 50.0);
        window.frame(None, vec![Event::PointerMoved(at)])
    });
    for colouring in [Colouring::Fate, Colouring::Residual, Colouring::Interval] {
        bench(&format!("colour-by-{}", colouring.title().to_lowercase()), &mut |i| {
            let other = if i % 2 == 0 { colouring } else { Colouring::Station };
            window.frame(Some(Command::Colour(other)), Vec::new())
        });
    }
    group.finish();
}

/// The whole window: menus, panes, scene. What the test harness keeps for screen readers is counted with it.
fn whole_window(criterion: &mut Criterion) {
    let mut harness = egui_kittest::Harness::builder()
        .with_size(egui::Vec2::new(1600.0, 1000.0))
        .renderer(offscreen_renderer().expect("a graphics driver"))
        .build_eframe(|creation| {
            let start = Start::Deployments(Vec::new());
            ResectWindow::new(creation, &start, Settings::default())
        });
    harness.state_mut().state.add(deployment(), None);
    harness.state_mut().settle();
    harness.run_steps(5);
    let (_, analysis) = harness.state().state.analysed().expect("analysed");
    let times_s = analysis.triplets().time_s.clone();
    let (ctx, start) = (harness.ctx.clone(), Instant::now());
    let mut group = criterion.benchmark_group("window");
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    group.warm_up_time(Duration::from_millis(5)).measurement_time(Duration::from_millis(40));
    for pane in [Pane::Residuals, Pane::Rates, Pane::Intervals] {
        harness.state_mut().send(Command::ShowPane(pane), &ctx);
        harness.run_steps(3);
        let mut number = 0..;
        group.bench_function(format!("cursor-{pane:?}").to_lowercase(), |b| {
            b.iter_custom(|frames| {
                let step = |i: usize| {
                    // The driver's threads share the processors; give them time to draw.
                    std::thread::sleep(Duration::from_millis(300));
                    let command = Command::MoveCursor(times_s[(i * 37) % times_s.len()]);
                    let before = thread_time(start);
                    harness.state_mut().send(command, &ctx);
                    harness.step();
                    thread_time(start) - before
                };
                number.by_ref().take(frames as usize).map(step).sum()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, scene, whole_window);
criterion_main!(benches);
