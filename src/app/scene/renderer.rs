//! Draws the scene into a texture of its own, which egui shows as an image.
//!
//! egui's own render pass has neither depth nor, in the test harness, samples; a texture with its own depth buffer
//! and four samples looks the same everywhere. Vertex buffers are written when their layer's version changes,
//! and the picture is drawn only when something in it changed.

use std::sync::Arc;

use eframe::egui_wgpu::{RenderState, wgpu};
use eframe::{egui, egui_wgpu};
use nalgebra::Matrix4;

use super::Camera;
use super::content::{Layer, LineVertex, PointVertex, SceneContent};
use crate::geometry::RigidTransform;

const SAMPLES: u32 = 4;
/// egui shows native textures of this format only.
const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
struct Uniforms {
    clip_from_world: [[f32; 4]; 4],
    world_from_frame: [[[f32; 4]; 4]; 4],
    viewport_pixels: [f32; 2],
    pixels_per_point: f32,
    padding: f32,
}

/// Pipelines, buffers and the texture.
pub struct SceneRenderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    egui_renderer: Arc<egui::mutex::RwLock<egui_wgpu::Renderer>>,
    points: wgpu::RenderPipeline,
    lines: wgpu::RenderPipeline,
    uniforms: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
    data: LayerBuffers,
    cursor: LayerBuffers,
    target: Option<Target>,
    drawn: Option<Drawn>,
}

/// What the present picture shows.
#[derive(PartialEq)]
struct Drawn {
    uniforms: Uniforms,
    versions: [u64; 2],
    background: [u8; 4],
}

struct Target {
    size: [u32; 2],
    multisampled: wgpu::TextureView,
    resolved: wgpu::TextureView,
    depth: wgpu::TextureView,
    shown: egui::TextureId,
}

#[derive(Default)]
struct LayerBuffers {
    version: Option<u64>,
    points: VertexBuffer,
    lines: VertexBuffer,
}

#[derive(Default)]
struct VertexBuffer {
    buffer: Option<wgpu::Buffer>,
    count: u32,
}

impl SceneRenderer {
    pub fn new(state: &RenderState) -> Self {
        let device = state.device.clone();
        let shader =
            device.create_shader_module(wgpu::include_wgsl!("../../../assets/shaders/scene.wgsl"));
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
        let pipeline = |name: &str, stride: usize, attributes: &[wgpu::VertexAttribute]| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(name),
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: &shader,
                    entry_point: Some(&format!("{name}_vertex")),
                    compilation_options: Default::default(),
                    buffers: &[Some(wgpu::VertexBufferLayout {
                        array_stride: stride as u64,
                        step_mode: wgpu::VertexStepMode::Instance,
                        attributes,
                    })],
                },
                primitive: wgpu::PrimitiveState {
                    topology: wgpu::PrimitiveTopology::TriangleStrip,
                    ..Default::default()
                },
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::LessEqual),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                multisample: wgpu::MultisampleState { count: SAMPLES, ..Default::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &shader,
                    entry_point: Some(&format!("{name}_fragment")),
                    compilation_options: Default::default(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format: COLOUR,
                        blend: Some(wgpu::BlendState::ALPHA_BLENDING),
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let points = pipeline(
            "point",
            size_of::<PointVertex>(),
            &wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32, 2 => Unorm8x4, 3 => Float32],
        );
        let lines = pipeline(
            "line",
            size_of::<LineVertex>(),
            &wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32, 2 => Float32x3, 3 => Uint32,
                4 => Unorm8x4, 5 => Float32],
        );
        Self {
            device,
            queue: state.queue.clone(),
            egui_renderer: Arc::clone(&state.renderer),
            points,
            lines,
            uniforms,
            bind_group,
            data: LayerBuffers::default(),
            cursor: LayerBuffers::default(),
            target: None,
            drawn: None,
        }
    }

    /// Draws if anything changed; gives the texture to show.
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
        self.data.upload(&self.device, &self.queue, &content.data);
        self.cursor.upload(&self.device, &self.queue, &content.cursor);
        let wanted = Drawn {
            uniforms: uniforms(content, camera, size, pixels_per_point),
            versions: [content.data.version, content.cursor.version],
            background: background.to_array(),
        };
        let target = self.target.as_ref().expect("just ensured");
        if self.drawn.as_ref() == Some(&wanted) {
            return target.shown;
        }
        self.queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(&wanted.uniforms));
        let mut encoder = self.device.create_command_encoder(&Default::default());
        {
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
            // Lines first: points stand on them.
            for (pipeline, buffers) in [
                (&self.lines, [&self.data.lines, &self.cursor.lines]),
                (&self.points, [&self.data.points, &self.cursor.points]),
            ] {
                pass.set_pipeline(pipeline);
                for vertices in buffers {
                    if let Some(buffer) = &vertices.buffer
                        && vertices.count > 0
                    {
                        pass.set_vertex_buffer(0, buffer.slice(..));
                        pass.draw(0..4, 0..vertices.count);
                    }
                }
            }
        }
        self.queue.submit([encoder.finish()]);
        self.drawn = Some(wanted);
        target.shown
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

impl LayerBuffers {
    fn upload(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, layer: &Layer) {
        if self.version == Some(layer.version) {
            return;
        }
        self.points.write(device, queue, bytemuck::cast_slice(&layer.points), layer.points.len());
        self.lines.write(device, queue, bytemuck::cast_slice(&layer.lines), layer.lines.len());
        self.version = Some(layer.version);
    }
}

impl VertexBuffer {
    /// Keeps the buffer while the vertices fit.
    fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, bytes: &[u8], count: usize) {
        self.count = count as u32;
        if bytes.is_empty() {
            return;
        }
        let fits = self.buffer.as_ref().is_some_and(|buffer| buffer.size() >= bytes.len() as u64);
        if !fits {
            self.buffer = Some(device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("scene vertices"),
                size: bytes.len() as u64,
                usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }));
        }
        if let Some(buffer) = &self.buffer {
            queue.write_buffer(buffer, 0, bytes);
        }
    }
}

fn uniforms(
    content: &SceneContent,
    camera: &Camera,
    size: [u32; 2],
    pixels_per_point: f32,
) -> Uniforms {
    let frame = |station: usize| {
        let transform = content.station1_from_station[station].unwrap_or(RigidTransform::IDENTITY);
        columns(&transform.matrix().cast::<f32>())
    };
    let viewport_pixels = size.map(|side| side as f32);
    Uniforms {
        clip_from_world: columns(&camera.clip_from_world(viewport_pixels[0] / viewport_pixels[1])),
        world_from_frame: [frame(0), frame(1), frame(2), columns(&Matrix4::identity())],
        viewport_pixels,
        pixels_per_point,
        padding: 0.0,
    }
}

fn columns(matrix: &Matrix4<f32>) -> [[f32; 4]; 4] {
    (*matrix).into()
}
