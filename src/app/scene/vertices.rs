//! Points, lines and labels of the scene, as input of the GPU and of the label placement.

use nalgebra::Vector3;

use resect_core::network::MOST_STATIONS;
use resect_tools::palette::Rgb;

/// Index of a vertex's frame: those of the stations are before it, the world is station 1's frame.
pub const WORLD: u32 = MOST_STATIONS as u32;

/// A disc of constant size on the screen.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct PointVertex {
    pub position_m: [f32; 3],
    pub frame: u32,
    pub colour: [u8; 4],
    pub diameter_points: f32,
}

/// A straight line of constant width on the screen.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct LineVertex {
    pub from_m: [f32; 3],
    pub from_frame: u32,
    pub to_m: [f32; 3],
    pub to_frame: u32,
    pub colour: [u8; 4],
    pub width_points: f32,
}

/// Priority of a label where there is no room for all; the last is placed first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rank {
    ControlPoint,
    Direction,
    Trajectory,
    Station,
}

/// Text at a position.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    pub position_m: Vector3<f32>,
    pub text: String,
    pub colour: Rgb,
    pub rank: Rank,
}

/// A possible end of a measurement, beside readings and tracks.
#[derive(Clone, Debug, PartialEq)]
pub struct Landmark {
    /// Position of the landmark (m, station 1's frame).
    pub position_m: Vector3<f64>,
    pub name: String,
}

/// A list of vertices, and a number that changes with them.
#[derive(Clone, Debug, Default)]
pub struct Layer {
    pub points: Vec<PointVertex>,
    pub lines: Vec<LineVertex>,
    pub version: u64,
}

impl Layer {
    pub fn clear(&mut self) {
        self.points.clear();
        self.lines.clear();
        self.version += 1;
    }
}

pub fn f32s(p: &Vector3<f64>) -> [f32; 3] {
    [p.x as f32, p.y as f32, p.z as f32]
}

pub fn opaque([r, g, b]: Rgb) -> [u8; 4] {
    [r, g, b, 255]
}
