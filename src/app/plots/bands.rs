//! Lines with bands about them as one shape; two shapes for each segment between gaps would cost more than all dots.

use std::ops::RangeInclusive;

use egui::{Color32, Mesh, Pos2, Shape, Ui};
use egui_plot::{PlotBounds, PlotGeometry, PlotItem, PlotItemBase, PlotPoint, PlotTransform};

use crate::app::prepared::series::Corner;

/// Half the width of a line (points).
const HALF_WIDTH: f32 = 0.8;
/// Opacity of a band.
const BAND: f32 = 0.35;

/// Lines of a plot, each with its band, in one colour.
pub struct Bands {
    base: PlotItemBase,
    lines: Vec<Vec<Corner>>,
    values: Vec<PlotPoint>,
    colour: Color32,
}

impl Bands {
    pub fn new(name: impl Into<String>, lines: Vec<Vec<Corner>>, colour: Color32) -> Self {
        let corners = lines.iter().flatten();
        let values = corners.map(|corner| PlotPoint::new(corner.since_s, corner.value)).collect();
        Self { base: PlotItemBase::new(name.into()), lines, values, colour }
    }
}

impl PlotItem for Bands {
    fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let fade = 1.0 / ui.ctx().pixels_per_point();
        let mut mesh = Mesh::default();
        let place = |x: f64, y: f64| transform.position_from_point(&PlotPoint::new(x, y));
        let band = self.colour.gamma_multiply(BAND);
        for two in self.lines.iter().flat_map(|line| line.windows(2)) {
            let edges = [0, 1].map(|end| {
                let Corner { since_s, low, high, .. } = two[end];
                [place(since_s, low), place(since_s, high)]
            });
            add_quad(&mut mesh, edges, band);
        }
        for two in self.lines.iter().flat_map(|line| line.windows(2)) {
            let ends = [0, 1].map(|end| place(two[end].since_s, two[end].value));
            add_line(&mut mesh, ends, self.colour, fade);
        }
        shapes.push(Shape::mesh(mesh));
    }

    fn initialize(&mut self, _x_range: RangeInclusive<f64>) {}

    fn color(&self) -> Color32 {
        self.colour
    }

    fn geometry(&self) -> PlotGeometry<'_> {
        PlotGeometry::Points(&self.values)
    }

    fn bounds(&self) -> PlotBounds {
        let mut bounds = PlotBounds::NOTHING;
        self.values.iter().for_each(|value| bounds.extend_with(value));
        bounds
    }

    fn base(&self) -> &PlotItemBase {
        &self.base
    }

    fn base_mut(&mut self) -> &mut PlotItemBase {
        &mut self.base
    }
}

/// Adds the quadrilateral between two edges, each from its lower to its upper end.
fn add_quad(mesh: &mut Mesh, edges: [[Pos2; 2]; 2], colour: Color32) {
    let first = mesh.vertices.len() as u32;
    edges.as_flattened().iter().for_each(|corner| mesh.colored_vertex(*corner, colour));
    mesh.add_triangle(first, first + 1, first + 2);
    mesh.add_triangle(first + 1, first + 2, first + 3);
}

/// Adds a segment of a line, which fades out to both sides over a pixel.
fn add_line(mesh: &mut Mesh, [from, to]: [Pos2; 2], colour: Color32, fade: f32) {
    let aside = (to - from).normalized().rot90();
    let steps = [
        (-HALF_WIDTH - 0.5 * fade, Color32::TRANSPARENT),
        (-HALF_WIDTH + 0.5 * fade, colour),
        (HALF_WIDTH - 0.5 * fade, colour),
        (HALF_WIDTH + 0.5 * fade, Color32::TRANSPARENT),
    ];
    let first = mesh.vertices.len() as u32;
    for end in [from, to] {
        steps.iter().for_each(|(step, colour)| mesh.colored_vertex(end + *step * aside, *colour));
    }
    for side in first..first + 3 {
        mesh.add_triangle(side, side + 1, side + 4);
        mesh.add_triangle(side + 1, side + 4, side + 5);
    }
}
