//! The window as an image, rendered off screen.

use eframe::egui_wgpu::{RenderState, RendererOptions, WgpuConfiguration, WgpuSetup};
use egui_kittest::wgpu::WgpuTestRenderer;

use super::model::{Pane, PictureFormat, PictureOrder};
use super::pictures::pane_picture::{self, PanePicture};
use super::window::{ResectWindow, Start};
use resect_core::analysis::Settings;

/// Choices for a picture of the window or of one of its panes.
#[derive(Clone, Copy, Debug)]
pub struct ScreenshotOrder {
    /// One pane without its controls; `None` for the whole window.
    pub pane: Option<Pane>,
    /// Format of a pane's picture; the whole window is PNG.
    pub format: PictureFormat,
    /// Width and height (points).
    pub size_points: [u32; 2],
    /// Pixels per point.
    pub scale: u32,
    pub dark: bool,
}

/// Renders the window or one pane off screen.
pub fn picture(
    start: &Start,
    settings: Settings,
    order: &ScreenshotOrder,
) -> anyhow::Result<PanePicture> {
    let state = offscreen_state()?;
    let order_of = |pane: Pane| PictureOrder {
        pane,
        format: order.format,
        size_points: order.size_points,
        scale: order.scale,
        dark: order.dark,
    };
    let whole = order_of(order.pane.unwrap_or(Pane::Scene));
    pane_picture::check_size(&state, &whole).map_err(anyhow::Error::msg)?;
    let mut harness = egui_kittest::Harness::builder()
        .with_size(order.size_points.map(|side| side as f32))
        .with_pixels_per_point(order.scale as f32)
        .with_theme(if order.dark { egui::Theme::Dark } else { egui::Theme::Light })
        .with_render_cursor(false)
        .allow_missing_glyphs()
        .with_accessibility_check(false)
        .renderer(WgpuTestRenderer::from_render_state(state))
        .build_eframe(|creation| {
            let mut window = ResectWindow::new(creation, start, settings);
            window.settle();
            window
        });
    // No frame is drawn during a job: progress texts would change the positions of glyphs in their texture. Glyphs at other positions are
    // sampled with other rounding.
    for _ in 0..5 {
        harness.run_steps(1);
        harness.state_mut().settle();
    }
    if let Some(pane) = order.pane {
        let ctx = harness.ctx.clone();
        let picture = harness.state_mut().picture(&order_of(pane), &ctx);
        return picture.map_err(anyhow::Error::msg);
    }
    let image = harness.render();
    image.map(PanePicture::Pixels).map_err(|what| {
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
