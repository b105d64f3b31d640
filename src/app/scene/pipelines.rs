//! The five render pipelines of the scene.

use wgpu;

use super::colouring::PointColour;
use super::vertices::{LineVertex, PointVertex};
use crate::app::prepared::TimedPoint;

pub const SAMPLES: u32 = 4;
/// Format of the texture: egui supports no other for native textures.
pub const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Pipelines, each with the name of its functions in the shader.
pub struct Pipelines {
    pub point: wgpu::RenderPipeline,
    pub line: wgpu::RenderPipeline,
    /// Draws readings.
    pub reading: wgpu::RenderPipeline,
    /// Draws tracks, from each point to the next.
    pub track: wgpu::RenderPipeline,
    /// Draws the segment of the tracks that is the trail.
    pub trail: wgpu::RenderPipeline,
}

impl Pipelines {
    pub fn new(device: &wgpu::Device, layout: &wgpu::PipelineLayout) -> Self {
        let shader =
            device.create_shader_module(wgpu::include_wgsl!("../../../assets/shaders/scene.wgsl"));
        let pipeline = |name: &str, fragment: &str, buffers: &[Buffer<'_>]| {
            pipeline(device, layout, &shader, [name, fragment], buffers)
        };
        let (place, colour) = (size_of::<TimedPoint>(), size_of::<PointColour>());
        let along: [Buffer<'_>; 3] = [
            (place, &wgpu::vertex_attr_array![0 => Float32x4]),
            (place, &wgpu::vertex_attr_array![1 => Float32x4]),
            (colour, &wgpu::vertex_attr_array![2 => Uint8x4]),
        ];
        Self {
            point: pipeline(
                "point",
                "point",
                &[(
                    size_of::<PointVertex>(),
                    &wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32, 2 => Unorm8x4, 3 => Float32],
                )],
            ),
            line: pipeline(
                "line",
                "line",
                &[(
                    size_of::<LineVertex>(),
                    &wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32, 2 => Float32x3,
                        3 => Uint32, 4 => Unorm8x4, 5 => Float32],
                )],
            ),
            reading: pipeline(
                "reading",
                "point",
                &[
                    (place, &wgpu::vertex_attr_array![0 => Float32x4]),
                    (colour, &wgpu::vertex_attr_array![1 => Uint8x4]),
                ],
            ),
            track: pipeline("track", "line", &along),
            trail: pipeline("trail", "line", &along),
        }
    }
}

/// Bytes of an instance, and its attributes.
type Buffer<'a> = (usize, &'a [wgpu::VertexAttribute]);

/// Returns a pipeline from the functions of the shader with this name.
fn pipeline(
    device: &wgpu::Device,
    layout: &wgpu::PipelineLayout,
    shader: &wgpu::ShaderModule,
    [name, fragment]: [&str; 2],
    buffers: &[Buffer<'_>],
) -> wgpu::RenderPipeline {
    let buffers: Vec<_> = buffers
        .iter()
        .map(|(stride, attributes)| {
            Some(wgpu::VertexBufferLayout {
                array_stride: *stride as u64,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes,
            })
        })
        .collect();
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(name),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module: shader,
            entry_point: Some(&format!("{name}_vertex")),
            compilation_options: Default::default(),
            buffers: &buffers,
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
            module: shader,
            entry_point: Some(&format!("{fragment}_fragment")),
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
}
