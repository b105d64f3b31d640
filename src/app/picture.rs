//! The window as an image, rendered off screen.

use std::sync::Arc;

use eframe::egui_wgpu::{RenderState, RendererOptions, WgpuConfiguration, WgpuSetup};
use egui_kittest::wgpu::WgpuTestRenderer;

use super::window::{ResectWindow, Start};
use resect_core::analysis::Settings;
use resect_core::deployment::Deployment;
use resect_io::source::Source;

/// The harness gives up on a frame after ten seconds, in which software renders about 40 million pixels.
const MOST_PIXELS_WITHOUT_GPU: u64 = 5120 * 2880;

/// Renders the window off screen as an image.
pub fn picture(
    deployments: Vec<(Arc<Deployment>, Source)>,
    settings: Settings,
    [width, height]: [u32; 2],
    dark: bool,
) -> anyhow::Result<image::RgbaImage> {
    let state = offscreen_state()?;
    let adapter = state.adapter.get_info();
    let pixels = u64::from(width) * u64::from(height);
    if adapter.device_type == wgpu::DeviceType::Cpu && pixels > MOST_PIXELS_WITHOUT_GPU {
        anyhow::bail!(
            "--size {width}x{height}: without a GPU the limit is 5120x2880 (renderer: {}); choose a smaller size",
            adapter.name
        );
    }
    let start = Start::Deployments(deployments);
    let mut harness = egui_kittest::Harness::builder()
        .with_size([width as f32, height as f32])
        .with_theme(if dark { egui::Theme::Dark } else { egui::Theme::Light })
        .with_render_cursor(false)
        .allow_missing_glyphs()
        .with_accessibility_check(false)
        .renderer(WgpuTestRenderer::from_render_state(state))
        .build_eframe(|creation| {
            let mut window = ResectWindow::new(creation, &start, settings);
            window.settle();
            window
        });
    // No frame is drawn during a job: progress texts would change the positions of glyphs in their texture. Glyphs at other positions are
    // sampled with other rounding.
    for _ in 0..5 {
        harness.run_steps(1);
        harness.state_mut().settle();
    }
    harness.render().map_err(|what| {
        anyhow::anyhow!("the picture could not be drawn ({what}); choose a smaller --size")
    })
}

/// Returns the off-screen renderer, or a one-line error; the harness itself would panic.
pub fn offscreen_renderer() -> anyhow::Result<WgpuTestRenderer> {
    Ok(WgpuTestRenderer::from_render_state(offscreen_state()?))
}

fn offscreen_state() -> anyhow::Result<RenderState> {
    let render_state = |backends: wgpu::Backends| {
        let mut setup = egui_kittest::wgpu::default_wgpu_setup();
        if let WgpuSetup::CreateNew(create) = &mut setup {
            create.instance_descriptor.backends &= backends;
        }
        let instance = pollster::block_on(setup.new_instance());
        let configuration = WgpuConfiguration { wgpu_setup: setup, ..Default::default() };
        let options = RendererOptions::PREDICTABLE;
        pollster::block_on(RenderState::create(&configuration, &instance, None, options))
    };
    // OpenGL is tried last, because probing it prints errors about missing displays.
    render_state(wgpu::Backends::PRIMARY)
        .or_else(|_| render_state(wgpu::Backends::all()))
        .map_err(|error| anyhow::anyhow!(without_graphics(&error)))
}

/// Message for a machine without a graphics driver, and its remedy.
pub fn without_graphics(error: &dyn std::fmt::Display) -> String {
    let remedy = if cfg!(target_os = "linux") {
        "on Debian and Ubuntu: apt install mesa-vulkan-drivers"
    } else {
        "install the driver of the graphics card's manufacturer"
    };
    format!("no graphics driver ({error}); {remedy}")
}
