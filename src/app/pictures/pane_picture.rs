//! One pane drawn by a context of its own, as pixels or as SVG.

use std::sync::Arc;

use eframe::egui_wgpu::{RenderState, Renderer, RendererOptions};
use egui::{Pos2, Rect, Theme, UiBuilder, Vec2};
use egui_kittest::TestRenderer;
use egui_kittest::wgpu::WgpuTestRenderer;

use super::svg_of_shapes::svg_of_shapes;
use crate::app::model::{PictureFormat, PictureOrder};
use crate::app::theme;

/// Passes until the layout no longer changes.
const PASSES: usize = 4;
/// Reading the pixels back has a limit of ten seconds, in which software renders about 40 million pixels.
const MOST_PIXELS_WITHOUT_GPU: u64 = 5120 * 2880;

pub enum PanePicture {
    Pixels(image::RgbaImage),
    Svg(String),
}

/// Returns a render state on the same device that no window uses.
pub fn offscreen(window: &RenderState) -> RenderState {
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let renderer = Renderer::new(&window.device, format, RendererOptions::PREDICTABLE);
    RenderState {
        target_format: format,
        renderer: Arc::new(egui::mutex::RwLock::new(renderer)),
        ..window.clone()
    }
}

impl PanePicture {
    /// Returns the content of the picture's file.
    pub fn encoded(&self) -> Result<Vec<u8>, String> {
        match self {
            Self::Svg(svg) => Ok(svg.clone().into_bytes()),
            Self::Pixels(image) => {
                let mut bytes = std::io::Cursor::new(Vec::new());
                image
                    .write_to(&mut bytes, image::ImageFormat::Png)
                    .map_err(|error| error.to_string())?;
                Ok(bytes.into_inner())
            }
        }
    }
}

/// Draws a pane off screen with what the window remembers of it: scroll positions, folded parts, zoomed axes.
///
/// `scope` is the pane's id in the window. `render_state` is one of [`offscreen`], with which `draw` draws the scene.
pub fn draw_pane(
    window: &egui::Context,
    render_state: RenderState,
    order: &PictureOrder,
    scope: egui::Id,
    mut draw: impl FnMut(&mut egui::Ui),
) -> Result<PanePicture, String> {
    check_size(&render_state, order)?;
    let ctx = egui::Context::default();
    ctx.memory_mut(|memory| *memory = window.memory(Clone::clone));
    ctx.options_mut(|options| options.zoom_factor = 1.0);
    theme::set_fonts(&ctx);
    ctx.set_theme(if order.dark { Theme::Dark } else { Theme::Light });
    let [width, height] = order.size_points.map(|side| side as f32);
    let place = Rect::from_min_size(Pos2::ZERO, Vec2::new(width, height));
    let time = window.input(|input| input.time);
    let mut renderer = WgpuTestRenderer::from_render_state(render_state);
    let mut output = egui::FullOutput::default();
    for _ in 0..PASSES {
        let mut input =
            egui::RawInput { screen_rect: Some(place), time: Some(time), ..Default::default() };
        let viewport = input.viewports.entry(egui::ViewportId::ROOT).or_default();
        viewport.native_pixels_per_point = Some(order.scale as f32);
        output = ctx.run_pass(input, |ctx| {
            let fill = ctx.global_style().visuals.panel_fill;
            let mut ui = egui::Ui::new(ctx.clone(), scope, UiBuilder::new().max_rect(place));
            ui.painter().rect_filled(place, 0.0, fill);
            draw(&mut ui);
        });
        renderer.handle_delta(&mut output.textures_delta);
    }
    match order.format {
        PictureFormat::Svg => Ok(PanePicture::Svg(svg_of_shapes(&output.shapes, place))),
        PictureFormat::Png => renderer.render(&ctx, &output).map(PanePicture::Pixels),
    }
}

/// Returns an error with the remedy if a picture is larger than the device can draw.
pub fn check_size(render_state: &RenderState, order: &PictureOrder) -> Result<(), String> {
    let largest = render_state.device.limits().max_texture_dimension_2d;
    let [width, height] = order.size_pixels();
    let adapter = render_state.adapter.get_info();
    let is_too_many = adapter.device_type == wgpu::DeviceType::Cpu
        && u64::from(width) * u64::from(height) > MOST_PIXELS_WITHOUT_GPU;
    if width.max(height) > largest {
        return Err(format!(
            "{width} × {height} pixels: the graphics device draws {largest} in each direction at most; choose a smaller size or scale"
        ));
    }
    if is_too_many {
        return Err(format!(
            "{width} × {height} pixels: without a GPU the limit is 5120 × 2880 (renderer: {}); choose a smaller size or scale",
            adapter.name
        ));
    }
    Ok(())
}
