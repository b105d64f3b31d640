//! Renderer of the scene into a texture of its own, which egui shows as an image.
//!
//! egui's own render pass has no depth buffer and, in the test harness, no multisampling; a
//! texture with its own depth buffer and four samples looks the same everywhere. Vertex buffers
//! are written when their layer's version changes, and the picture is drawn only after a change.

use std::ops::Range;
use std::sync::Arc;

use eframe::egui_wgpu::{self, RenderState};
use nalgebra::Matrix4;

use super::buffers::{CloudBuffers, LayerBuffers};
use super::content::SceneContent;
use super::pipelines::{COLOUR, DEPTH, Pipelines, SAMPLES};
use super::trail::Trail;
use super::vertices::Layer;
use crate::app::model::Camera;
use crate::app::prepared::Cloud;
use resect_core::geometry::RigidTransform;
use resect_core::network::{MOST_STATIONS, Number, PerStation, Station};

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
struct Uniforms {
    clip_from_world: [[f32; 4]; 4],
    world_from_frame: [[[f32; 4]; 4]; MOST_STATIONS + 1],
    background: [f32; 4],
    viewport_pixels: [f32; 2],
    /// Selected span (s); readings and tracks at other times are dimmed.
    selection_s: [f32; 2],
    pixels_per_point: f32,
    /// Bit mask of the fates that are shown.
    shown_fates: u32,
    /// Start and end of the trail (s).
    trail_s: [f32; 2],
}

/// Number of layers; with fewer buffers the last layers would be silently omitted.
const LAYERS: usize = 10;

/// Pipelines, buffers and the texture.
pub struct SceneRenderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    egui_renderer: Arc<egui::mutex::RwLock<egui_wgpu::Renderer>>,
    pipelines: Pipelines,
    uniforms: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
    raw: CloudBuffers,
    tracks: CloudBuffers,
    /// Buffers of the [`layers`], in their order.
    layers: [LayerBuffers; LAYERS],
    target: Option<Target>,
    drawn: Option<RenderedPicture>,
}

/// State of the content of the present picture.
#[derive(PartialEq)]
struct RenderedPicture {
    uniforms: Uniforms,
    /// Version numbers of clouds and colours, then of each layer.
    versions: [u64; 2 + LAYERS],
    shown: [PerStation<bool>; 2],
    trail: Trail,
}

struct Target {
    size: [u32; 2],
    multisampled: wgpu::TextureView,
    resolved: wgpu::TextureView,
    depth: wgpu::TextureView,
    shown: egui::TextureId,
}

impl SceneRenderer {
    pub fn new(state: &RenderState) -> Self {
        let device = state.device.clone();
        let uniforms = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("scene uniforms"),
            size: size_of::<Uniforms>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("scene"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("scene"),
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniforms.as_entire_binding() }],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("scene"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        Self {
            pipelines: Pipelines::new(&device, &pipeline_layout),
            device,
            queue: state.queue.clone(),
            egui_renderer: Arc::clone(&state.renderer),
            uniforms,
            bind_group,
            raw: CloudBuffers::default(),
            tracks: CloudBuffers::default(),
            layers: Default::default(),
            target: None,
            drawn: None,
        }
    }

    /// Draws if anything has changed; returns the texture to show.
    pub fn draw(
        &mut self,
        content: &SceneContent,
        camera: &Camera,
        size_points: egui::Vec2,
        pixels_per_point: f32,
        background: egui::Color32,
    ) -> egui::TextureId {
        let largest = self.device.limits().max_texture_dimension_2d;
        let pixels = |points: f32| ((points * pixels_per_point).round() as u32).clamp(1, largest);
        let size = [pixels(size_points.x), pixels(size_points.y)];
        self.ensure_target(size);
        self.upload(content);
        let mut versions = [0; 2 + LAYERS];
        versions[..2].copy_from_slice(&[content.clouds_version, content.colours_version]);
        versions[2..].copy_from_slice(&layers(content).map(|layer| layer.version));
        let wanted = RenderedPicture {
            uniforms: uniforms(content, camera, size, pixels_per_point, background),
            versions,
            shown: [content.raw_shown.clone(), content.tracks_shown.clone()],
            trail: content.trail.clone(),
        };
        let target = self.target.as_ref().expect("just ensured");
        if self.drawn.as_ref() == Some(&wanted) {
            return target.shown;
        }
        self.queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(&wanted.uniforms));
        let mut encoder = self.device.create_command_encoder(&Default::default());
        self.encode(&mut encoder, target, content, background);
        self.queue.submit([encoder.finish()]);
        self.drawn = Some(wanted);
        target.shown
    }

    fn upload(&mut self, content: &SceneContent) {
        let (device, queue) = (&self.device, &self.queue);
        for (buffers, cloud, colours) in [
            (&mut self.raw, &content.clouds.raw, &content.colours.raw),
            (&mut self.tracks, &content.clouds.tracks, &content.colours.tracks),
        ] {
            let cloud = (&**cloud, content.clouds_version);
            buffers.upload(device, queue, cloud, (colours, content.colours_version));
        }
        for (buffers, layer) in self.layers.iter_mut().zip(layers(content)) {
            buffers.upload(device, queue, layer);
        }
    }

    fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &Target,
        content: &SceneContent,
        background: egui::Color32,
    ) {
        let [r, g, b, a] = background.to_array().map(|c| f64::from(c) / 255.0);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.multisampled,
                depth_slice: None,
                resolve_target: Some(&target.resolved),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
                    store: wgpu::StoreOp::Discard,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &target.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.bind_group, &[]);
        // Lines first: points cover them.
        pass.set_pipeline(&self.pipelines.track);
        for (range, _) in shown(&content.clouds.tracks, &content.tracks_shown) {
            self.tracks.draw_lines(&mut pass, range);
        }
        pass.set_pipeline(&self.pipelines.line);
        self.layers.iter().for_each(|layer| layer.lines.draw(&mut pass));
        pass.set_pipeline(&self.pipelines.reading);
        for (range, _) in shown(&content.clouds.raw, &content.raw_shown) {
            self.raw.draw_points(&mut pass, range);
        }
        pass.set_pipeline(&self.pipelines.trail);
        for range in &content.trail.ranges {
            self.tracks.draw_lines(&mut pass, range);
        }
        pass.set_pipeline(&self.pipelines.point);
        self.layers.iter().for_each(|layer| layer.points.draw(&mut pass));
    }

    fn ensure_target(&mut self, size: [u32; 2]) {
        if self.target.as_ref().is_some_and(|target| target.size == size) {
            return;
        }
        let texture = |label: &str, format, sample_count, usage| {
            let texture = self.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            });
            texture.create_view(&Default::default())
        };
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let multisampled = texture("scene samples", COLOUR, SAMPLES, attachment);
        let depth = texture("scene depth", DEPTH, SAMPLES, attachment);
        let resolved =
            texture("scene", COLOUR, 1, attachment | wgpu::TextureUsages::TEXTURE_BINDING);
        let mut renderer = self.egui_renderer.write();
        let filter = wgpu::FilterMode::Nearest;
        let shown = match &self.target {
            None => renderer.register_native_texture(&self.device, &resolved, filter),
            Some(old) => {
                let id = old.shown;
                renderer.update_egui_texture_from_wgpu_texture(&self.device, &resolved, filter, id);
                id
            }
        };
        self.target = Some(Target { size, multisampled, resolved, depth, shown });
        self.drawn = None;
    }
}

/// Returns the ranges of the shown stations' points.
fn shown<'a>(
    cloud: &'a Cloud,
    shown: &'a PerStation<bool>,
) -> impl Iterator<Item = (&'a Range<usize>, &'a bool)> {
    cloud.ranges.iter().zip(shown).filter(|(_, shown)| **shown)
}

/// Returns the layers in drawing order.
fn layers(content: &SceneContent) -> [&Layer; LAYERS] {
    [
        &content.ground,
        &content.along,
        &content.tube,
        &content.beside,
        &content.advised,
        &content.estimates,
        &content.data,
        &content.hover,
        &content.cursor,
        &content.ruler,
    ]
}

fn uniforms(
    content: &SceneContent,
    camera: &Camera,
    size: [u32; 2],
    pixels_per_point: f32,
    background: egui::Color32,
) -> Uniforms {
    let frame = |station: usize| {
        let transform = content.station1_from_station.get(Station::at(station)).copied().flatten();
        columns(&transform.unwrap_or(RigidTransform::IDENTITY).matrix().cast::<f32>())
    };
    let viewport_pixels = size.map(|side| side as f32);
    Uniforms {
        clip_from_world: columns(&camera.clip_from_world(viewport_pixels[0] / viewport_pixels[1])),
        world_from_frame: std::array::from_fn(frame),
        background: background.to_array().map(|c| f32::from(c) / 255.0),
        viewport_pixels,
        selection_s: content.selection_s.unwrap_or([f32::MIN, f32::MAX]),
        pixels_per_point,
        shown_fates: content.shown_fates,
        trail_s: content.trail.span_s,
    }
}

fn columns(matrix: &Matrix4<f32>) -> [[f32; 4]; 4] {
    (*matrix).into()
}
