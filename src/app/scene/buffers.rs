//! Vertex buffers, rewritten when their content changes.

use std::ops::Range;

use wgpu;

use super::colouring::PointColour;
use super::vertices::Layer;
use crate::app::prepared::Cloud;

/// Points and lines of a layer.
#[derive(Default)]
pub struct LayerBuffers {
    version: Option<u64>,
    pub points: VertexBuffer,
    pub lines: VertexBuffer,
}

/// Positions and colours of a cloud, each written independently of the other.
#[derive(Default)]
pub struct CloudBuffers {
    version: Option<u64>,
    colours_version: Option<u64>,
    points: VertexBuffer,
    colours: VertexBuffer,
}

#[derive(Default)]
pub struct VertexBuffer {
    buffer: Option<wgpu::Buffer>,
    count: u32,
    /// Bytes from one vertex to the next.
    stride: u64,
}

impl LayerBuffers {
    pub fn upload(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, layer: &Layer) {
        if self.version == Some(layer.version) {
            return;
        }
        self.points.write(device, queue, &layer.points);
        self.lines.write(device, queue, &layer.lines);
        self.version = Some(layer.version);
    }
}

impl CloudBuffers {
    pub fn upload(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        (cloud, version): (&Cloud, u64),
        (colours, colours_version): (&[PointColour], u64),
    ) {
        if self.version != Some(version) {
            self.points.write(device, queue, &cloud.points);
            self.version = Some(version);
        }
        if self.colours_version != Some(colours_version) {
            self.colours.write(device, queue, colours);
            self.colours_version = Some(colours_version);
        }
    }

    /// Draws a range of points, each as an instance.
    pub fn draw_points(&self, pass: &mut wgpu::RenderPass<'_>, range: &Range<usize>) {
        self.draw(pass, range.len(), &[(&self.points, range.start), (&self.colours, range.start)]);
    }

    /// Draws the lines from each point of a range to the next; the shader omits pairs that are not joined.
    pub fn draw_lines(&self, pass: &mut wgpu::RenderPass<'_>, range: &Range<usize>) {
        let next = range.start + 1;
        let from = [(&self.points, range.start), (&self.points, next), (&self.colours, next)];
        self.draw(pass, range.len().saturating_sub(1), &from);
    }

    /// Draws instances whose attributes come from several buffers, each from an offset on.
    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, count: usize, from: &[(&VertexBuffer, usize)]) {
        // Clouds and colours belong to the same analysis; this check prevents a read beyond the end if they ever do not.
        let there = |(vertices, start): &(&VertexBuffer, usize)| {
            vertices.buffer.is_some() && start + count <= vertices.count as usize
        };
        if count == 0 || !from.iter().all(there) {
            return;
        }
        for (slot, (vertices, start)) in from.iter().enumerate() {
            if let Some(buffer) = &vertices.buffer {
                let offset = *start as u64 * vertices.stride;
                pass.set_vertex_buffer(slot as u32, buffer.slice(offset..));
            }
        }
        pass.draw(0..4, 0..count as u32);
    }
}

impl VertexBuffer {
    /// Writes vertices; reuses the buffer while they fit.
    fn write<V: bytemuck::Pod>(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        vertices: &[V],
    ) {
        self.count = vertices.len() as u32;
        self.stride = size_of::<V>() as u64;
        if vertices.is_empty() {
            return;
        }
        let bytes: &[u8] = bytemuck::cast_slice(vertices);
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

    /// Draws all vertices, each as an instance.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(buffer) = self.buffer.as_ref().filter(|_| self.count > 0) {
            pass.set_vertex_buffer(0, buffer.slice(..));
            pass.draw(0..4, 0..self.count);
        }
    }
}
